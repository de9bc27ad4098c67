//! Loading glTF: real models, and one made by hand for each feature.

mod common;

use scene::Scene;

fn warnings(scene: &Scene) -> Vec<String> {
    scene.warnings.iter().map(ToString::to_string).collect()
}

#[test]
fn real_models() {
    for f in ["gltf/FlightHelmet/FlightHelmet.gltf","gltf/boom_box.glb","gltf/sports_car_2.glb","gltf/clearcoat_test.glb","gltf/shaderball.glb"] {
        let Some(s) = common::load_test_data(f) else {return};
        println!("{} tri {} placed, {} meshes {} inst {} mats {} tex {} lights, bounds {:?} {:?}", s.meshes.iter().map(|m|m.triangles.len()).sum::<usize>(), s.triangle_count(), s.meshes.len(), s.instances.len(), s.materials.len(), s.textures.len(), s.lights.len(), s.bounds(), warnings(&s));
        for m in &s.materials { println!("  {} {:?} m{} r{} cc{:?} em{} bc{} n{} mr{}", m.name, m.alpha_mode, m.metallic, m.roughness, m.clearcoat.factor, m.emissive, m.base_color, m.normal_texture.is_some(), m.metallic_roughness_texture.is_some()); }
    }
}
