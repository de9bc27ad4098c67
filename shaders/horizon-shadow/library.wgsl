// The functions of horizon-shadow, for a host's own shader.

// A point of the surface that the height map lies on.
struct HorizonShadowSurface {
    // Texture coordinates of the mesh, and how they change from pixel to pixel.
    uv: vec2f,
    uv_dx: vec2f,
    uv_dy: vec2f,
    // Unit normal of the base surface.
    normal_world: vec3f,
    // Change of the base position along u and v of the mesh, metres per unit.
    along_u_world: vec3f,
    along_v_world: vec3f,
    // Second fundamental form in those: II(u,u), II(u,v), II(v,v), metres, convex positive.
    second_form: vec3f,
}
