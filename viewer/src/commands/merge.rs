//! `sheen merge`: references of different samples of one picture become one.

use super::reference::{describe, print_counts};
use super::{Failure, print};
use crate::{cli::MergeArguments, output::Format, pictures::film};
use path_tracer::Merge;
use scene::output::write_whole;

pub(crate) fn run(arguments: &MergeArguments) -> Result<(), Failure> {
    Format::of_path(&arguments.out, &[Format::Exr])?;
    let mut merge = None;
    for path in &arguments.files {
        let (name, film) = (path.display().to_string(), film(path)?);
        match &mut merge {
            None => merge = Some(Merge::new(name, film)),
            Some(merge) => merge.add(name, &film)?,
        }
    }
    let Some(merge) = merge else {
        return Err(Failure::Usage("expected one or more references".into()));
    };
    let film = merge.finish();
    print_counts(&film);
    write_whole(&arguments.out, &film.to_exr()?)?;
    print(&format!("{}: {}\n", arguments.out.display(), describe(&film)?));
    Ok(())
}
