//! The node hierarchy: where meshes, lights and the camera stand.

use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use ::gltf::json;
use glam::{Mat4, Quat, Vec3};
use json::extensions::scene::khr_lights_punctual::{Light as LightJson, Type as LightType};
use json::validation::Checked;

use super::Document;
use crate::load::warnings::Warnings;
use crate::{Camera, Error, Light};


/// A mesh of the file, placed in the world.
pub(super) struct Placement {
    pub(super) name: String,
    pub(super) mesh: usize,
    pub(super) world_from_local: Mat4,
}

/// Everything that stands somewhere.
#[derive(Default)]
pub(super) struct Hierarchy {
    pub(super) placements: Vec<Placement>,
    pub(super) lights: Vec<Light>,
    /// The first perspective camera; its target is one metre ahead.
    pub(super) camera: Option<Camera>,
}

/// Walks the scene's nodes, parents first. A node that is reached twice is an error, so that the
/// walk ends: glTF hierarchies are trees.
pub(super) fn walk(document: &Document, warnings: &mut Warnings) -> Result<Hierarchy, Error> {
    let mut hierarchy = Hierarchy::default();
    let mut reached = vec![false; document.root.nodes.len()];
    let mut open: Vec<(usize, Mat4, String)> = Vec::new();
    for (index, place) in roots(document, warnings)?.into_iter().rev() {
        open.push((index, Mat4::IDENTITY, place));
    }
    while let Some((index, world_from_parent, place)) = open.pop() {
        let node = document.get(&document.root.nodes, json::Index::new(index as u32), &place)?;
        if std::mem::replace(reached.get_mut(index).unwrap_or(&mut true), true) {
            return Err(document.error(
                place,
                format!("node {index} a second time"),
                "a tree: one parent per node",
            ));
        }
        let place = format!("nodes[{index}]");
        let world_from_local = world_from_parent * local_matrix(document, node, &place)?;
        if !world_from_local.is_finite() {
            return Err(document.error(place, "a transform that is not finite", "finite numbers"));
        }
        add_mesh(document, node, &place, world_from_local, &mut hierarchy, warnings)?;
        add_light(document, node, &place, world_from_local, &mut hierarchy, warnings)?;
        add_camera(document, node, &place, world_from_local, &mut hierarchy, warnings)?;
        for (position, child) in node.children.as_deref().unwrap_or_default().iter().enumerate().rev() {
            open.push((child.value(), world_from_local, format!("{place}.children[{position}]")));
        }
    }
    Ok(hierarchy)
}

/// The nodes to start from, and where they are named: those of the default scene, else of the
/// first, else (a file without scenes) all that are nobody's child.
fn roots(document: &Document, warnings: &mut Warnings) -> Result<Vec<(usize, String)>, Error> {
    let root = document.root;
    if root.scenes.is_empty() && root.scene.is_none() {
        let mut is_child = vec![false; root.nodes.len()];
        for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
            if let Some(is_child) = is_child.get_mut(child.value()) {
                *is_child = true;
            }
        }
        let roots = is_child.iter().enumerate().filter(|(_, is_child)| !**is_child);
        return Ok(roots.map(|(index, _)| (index, format!("nodes[{index}]"))).collect());
    }
    let index = root.scene.unwrap_or_else(|| json::Index::new(0));
    let scene = document.get(&root.scenes, index, "scene")?;
    if root.scenes.len() > 1 {
        let message = format!("only scene {} of {} is loaded", index.value(), root.scenes.len());
        warnings.add("scenes", message);
    }
    let place = |position| format!("scenes[{}].nodes[{position}]", index.value());
    Ok(scene.nodes.iter().enumerate().map(|(position, node)| (node.value(), place(position))).collect())
}

fn local_matrix(document: &Document, node: &json::Node, place: &str) -> Result<Mat4, Error> {
    if let Some(matrix) = node.matrix {
        let matrix = Mat4::from_cols_array(&matrix);
        return if matrix.row(3) == glam::Vec4::W {
            Ok(matrix)
        } else {
            let found = format!("the bottom row {}", matrix.row(3));
            Err(document.error(format!("{place}.matrix"), found, "an affine matrix, bottom row [0, 0, 0, 1]"))
        };
    }
    let rotation = glam::Vec4::from(node.rotation.unwrap_or_default().0);
    let rotation = rotation.try_normalize().map(Quat::from_vec4).ok_or_else(|| {
        document.error(format!("{place}.rotation"), format!("{rotation}"), "a quaternion of unit length")
    })?;
    let scale = Vec3::from(node.scale.unwrap_or([1.0; 3]));
    let translation = Vec3::from(node.translation.unwrap_or_default());
    Ok(Mat4::from_scale_rotation_translation(scale, rotation, translation))
}

fn add_mesh(
    document: &Document,
    node: &json::Node,
    place: &str,
    world_from_local: Mat4,
    hierarchy: &mut Hierarchy,
    warnings: &mut Warnings,
) -> Result<(), Error> {
    let Some(mesh) = node.mesh else { return Ok(()) };
    document.get(&document.root.meshes, mesh, &format!("{place}.mesh"))?;

    if !crate::check::is_usable(world_from_local) {
        warnings.add(place, "a mesh that is scaled to nothing is left out");
        return Ok(());
    }
    let name = node
        .name
        .clone()
        .unwrap_or_else(|| format!("node {}", place.trim_matches(|c: char| !c.is_ascii_digit())));
    hierarchy.placements.push(Placement { name, mesh: mesh.value(), world_from_local });
    Ok(())
}

fn add_light(
    document: &Document,
    node: &json::Node,
    place: &str,
    world_from_local: Mat4,
    hierarchy: &mut Hierarchy,
    warnings: &mut Warnings,
) -> Result<(), Error> {
    let reference = node.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    let Some(index) = reference.map(|reference| reference.light) else { return Ok(()) };
    let lights =
        document.root.extensions.as_ref().and_then(|extensions| extensions.khr_lights_punctual.as_ref());
    let lights = lights.map_or(&[][..], |extension| &extension.lights);
    let light = document.get(lights, index, &format!("{place}.extensions.KHR_lights_punctual.light"))?;
    let place = format!("extensions.KHR_lights_punctual.lights[{}]", index.value());
    hierarchy.lights.extend(convert_light(document, light, &place, world_from_local, warnings)?);
    Ok(())
}

/// A light as it stands in the world: candela and lux are kept as they are. Nothing for one whose
/// direction is lost in a scale of 0.
fn convert_light(
    document: &Document,
    light: &LightJson,
    place: &str,
    world_from_local: Mat4,
    warnings: &mut Warnings,
) -> Result<Option<Light>, Error> {
    let strength = Vec3::from(light.color) * light.intensity;
    if !strength.is_finite() || strength.min_element() < 0.0 {
        return Err(document.error(place, format!("the intensity {strength}"), "finite numbers, 0 or more"));
    }
    let Some(direction_world) = world_from_local.transform_vector3(Vec3::NEG_Z).try_normalize() else {
        warnings.add(place, "a light that is scaled to nothing is left out");
        return Ok(None);
    };
    let position_world = world_from_local.w_axis.truncate();
    let range = light.range.filter(|range| *range > 0.0).unwrap_or(f32::INFINITY);
    let Checked::Valid(kind) = light.type_ else {
        return Err(document.error(format!("{place}.type"), "an unknown name", "directional, point or spot"));
    };
    Ok(Some(match kind {
        LightType::Directional => Light::Directional {
            direction_world: -direction_world,
            irradiance: strength,
            angular_diameter_rad: 0.0,
        },
        LightType::Point => Light::Point { position_world, intensity: strength, range },
        LightType::Spot => {
            let spot = light.spot.as_ref();
            let inner_angle_rad = spot.map_or(0.0, |spot| spot.inner_cone_angle);
            let outer_angle_rad = spot.map_or(FRAC_PI_4, |spot| spot.outer_cone_angle);
            if !(0.0 <= inner_angle_rad && inner_angle_rad < outer_angle_rad && outer_angle_rad <= FRAC_PI_2) {
                let found = format!("cone angles {inner_angle_rad} and {outer_angle_rad}");
                let expected = "0 <= innerConeAngle < outerConeAngle <= pi/2";
                return Err(document.error(format!("{place}.spot"), found, expected));
            }
            Light::Spot {
                position_world,
                direction_world,
                intensity: strength,
                range,
                inner_angle_rad,
                outer_angle_rad,
            }
        }
    }))
}

fn add_camera(
    document: &Document,
    node: &json::Node,
    place: &str,
    world_from_local: Mat4,
    hierarchy: &mut Hierarchy,
    warnings: &mut Warnings,
) -> Result<(), Error> {
    let Some(index) = node.camera else { return Ok(()) };
    let camera = document.get(&document.root.cameras, index, &format!("{place}.camera"))?;
    let place = format!("cameras[{}]", index.value());
    let Some(perspective) = &camera.perspective else {
        warnings.add(place, "a camera that is not perspective is ignored");
        return Ok(());
    };
    if hierarchy.camera.is_some() {
        warnings.add(place, "cameras after the first are ignored");
        return Ok(());
    }
    if !(perspective.yfov > 0.0 && perspective.yfov < PI) {
        return Err(document.error(
            place + ".perspective.yfov",
            perspective.yfov.to_string(),
            "0 < yfov < pi",
        ));
    }
    let forward = world_from_local.transform_vector3(Vec3::NEG_Z).try_normalize();
    let up = world_from_local.transform_vector3(Vec3::Y).try_normalize();
    let (Some(forward), Some(up)) =
        (forward, up.filter(|up| forward.is_some_and(|forward| up.dot(forward).abs() < 0.999)))
    else {
        warnings.add(place, "a camera that is scaled to nothing is ignored");
        return Ok(());
    };
    let eye = world_from_local.w_axis.truncate();
    hierarchy.camera = Some(Camera { eye, target: eye + forward, up, fov_y_rad: perspective.yfov });
    Ok(())
}

/// Moves a camera's target along its view to where the middle of the scene is, so that turning
/// about the target turns about the scene. The picture stays the same.
pub(super) fn aim_at_scene(camera: Camera, bounds: Option<(Vec3, Vec3)>) -> Camera {
    let Some((low, high)) = bounds else { return camera };
    let forward = camera.target - camera.eye;
    let distance = (0.5 * (low + high) - camera.eye).dot(forward);
    let target = camera.eye + forward * distance;
    if distance > 0.01 && target.is_finite() { Camera { target, ..camera } } else { camera }
}
