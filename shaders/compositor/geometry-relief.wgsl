// Geometry pass for materials with a height map: the normal is that of the relief.

@group(2) @binding(0) var<uniform> relief: CompositorRelief;
@group(2) @binding(1) var heights: texture_2d<f32>;

@fragment
fn geometry_relief_fragment(in: ReliefOut, @builtin(front_facing) front_facing: bool) -> SurfaceOut {
    let base = vertex_out(in);
    let texels = in.uv * relief.uv_scale * relief.size;
    let footprint = max(length(dpdx(texels)), length(dpdy(texels)));
    let normal = compositor_height_normal(heights, relief, in.uv, footprint,
        sheen_normalize_or(in.normal_world, vec3f(0.0, 1.0, 0.0)), in.along_u_world, in.along_v_world);
    var bumped = base;
    bumped.normal_world = normal;
    return finished(bumped, front_facing, shaded(base), normal);
}
