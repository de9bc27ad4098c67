//! Stub
use crate::{Scene,Error,Limits};use std::path::Path;
/// x
pub fn obj_from_bytes(_:&str,_:&[u8],_:Option<&Path>,_:&Limits)->Result<Scene,Error>{ Ok(Scene::default()) }
