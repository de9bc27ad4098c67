// A surface point, and what a light makes of it: azimuth in texels, curvature, turn by torsion, and
// the stored azimuths around it.

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

// What the light's azimuth makes of a surface point: everything that is looked up depends on these.
struct HorizonShadowView {
    // The point in texels of the map, texel centres at whole numbers, reduced.
    at: vec2f,
    // Map uv, for samplers.
    uv: vec2f,
    // Unit direction towards the light in texels.
    direction: vec2f,
    // How that changes with a texel of height above the base, because normals ahead lean sideways.
    turn: vec2f,
    // Of the light above the base surface.
    sine: f32,
    cosine: f32,
    // Normal curvature along the azimuth, 1 / texel.
    kappa: f32,
    // Texels between the map's 0 and 1 along the azimuth, and the same against the bake's.
    texels_per_height: f32,
    steepening: f32,
    // Whether the surface has a metric there.
    known: bool,
}

fn horizon_shadow_is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

// x where it is finite, and within +-bound.
fn horizon_shadow_bounded(x: f32, bound: f32) -> f32 {
    return clamp(select(0.0, x, horizon_shadow_is_finite(x)), -bound, bound);
}

// The map's own uv of a surface point: 0..1, turned where the map repeats.
fn horizon_shadow_map_uv(parameters: HorizonShadowParameters, uv: vec2f) -> vec2f {
    let scaled = uv * parameters.uv_scale;
    let finite = vec2f(horizon_shadow_bounded(scaled.x, 1e6), horizon_shadow_bounded(scaled.y, 1e6));
    let repeats = vec2<bool>((parameters.wrap & 1u) != 0u, (parameters.wrap & 2u) != 0u);
    return select(clamp(finite, vec2f(0.0), vec2f(1.0)), fract(finite), repeats);
}

// Light in the surface's frame. Its azimuth in texels comes from its contravariant components
// u = L.(Pv x N) / J, v = L.(N x Pu) / J, J = N.(Pu x Pv), whatever the parametrisation.
fn horizon_shadow_view(
    parameters: HorizonShadowParameters, surface: HorizonShadowSurface, light_world: vec3f,
) -> HorizonShadowView {
    var view: HorizonShadowView;
    view.uv = horizon_shadow_map_uv(parameters, surface.uv);
    view.at = view.uv * parameters.size - 0.5;
    let normal = sheen_normalize_or(surface.normal_world, vec3f(0.0));
    let sine = dot(light_world, normal);
    let tangential = light_world - sine * normal;
    let squared = dot(tangential, tangential);
    view.sine = horizon_shadow_bounded(sine, 1.0);
    view.cosine = abs(horizon_shadow_bounded(sqrt(squared), 1.0));

    let u = surface.along_u_world;
    let v = surface.along_v_world;
    let area = dot(normal, cross(u, v));
    // At the zenith every azimuth will do.
    let off_zenith = squared > 1e-12;
    let along_u = u - dot(u, normal) * normal;
    let towards = select(along_u, tangential, off_zenith);
    let along_squared = select(dot(along_u, along_u), squared, off_zenith);
    // Mesh uv, and texels, while going along `towards`.
    let rate = vec2f(dot(towards, cross(v, normal)), dot(towards, cross(normal, u))) / area;
    let texel_rate = rate * parameters.uv_scale * parameters.size;
    let rate_squared = dot(texel_rate, texel_rate);
    let per_rate = inverseSqrt(rate_squared);
    let per_along = inverseSqrt(along_squared);
    let form = surface.second_form;
    let bending = form.x * rate.x * rate.x + 2.0 * form.y * rate.x * rate.y + form.z * rate.y * rate.y;
    // Texels a metre are rate_squared * per_rate * per_along.
    view.direction = texel_rate * per_rate;
    // The same of the tangent vector to the left of `towards`, as long as that, and the geodesic torsion.
    let left = vec2f(-dot(towards, v), dot(towards, u)) / area;
    let torsion = (form.x * rate.x * left.x + form.y * (rate.x * left.y + rate.y * left.x)
        + form.z * rate.y * left.y) * per_along * per_rate;
    let turn = (-torsion * per_rate) * left * parameters.uv_scale * parameters.size;
    view.turn = vec2f(horizon_shadow_bounded(turn.x, 1e6), horizon_shadow_bounded(turn.y, 1e6));
    view.kappa = horizon_shadow_bounded(bending * per_along * per_rate, 1e3);
    view.texels_per_height = horizon_shadow_bounded(
        parameters.height_scale_m * (rate_squared * per_rate) * per_along, 1e6);
    view.steepening = horizon_shadow_bounded(view.texels_per_height / parameters.texels_per_height, 1e6);
    view.known = area * area > 1e-12 * dot(u, u) * dot(v, v)
        && horizon_shadow_is_finite(view.direction.x + view.direction.y) && rate_squared > 0.0;
    return view;
}

// The same towards points that lie so many units of the map above its base. With t the unit vector
// towards the light, w = n x t and the geodesic torsion tau = II(t, w), the normal at x t + y w leans
// by tau x towards w, so that what stands `height` high there is in the light's plane where
// y = -tau height x. Distances still are those along t.
fn horizon_shadow_turned(view: HorizonShadowView, height: f32) -> HorizonShadowView {
    let lean = view.turn * horizon_shadow_bounded(view.texels_per_height * height, 1e6);
    // Shorter than the direction, so that some direction is left, however thick the relief.
    let way = view.direction + lean * min(1.0, 0.75 * inverseSqrt(max(dot(lean, lean), 1e-12)));
    let squared = dot(way, way);
    let per_way = inverseSqrt(squared);
    var turned = view;
    turned.direction = way * per_way;
    turned.kappa = view.kappa * per_way;
    turned.texels_per_height = view.texels_per_height * (squared * per_way);
    turned.steepening = view.steepening * (squared * per_way);
    return turned;
}

fn horizon_shadow_sine_of(tangent: f32) -> f32 {
    return tangent * inverseSqrt(1.0 + tangent * tangent);
}

fn horizon_shadow_sines_of(tangent: vec4f) -> vec4f {
    return tangent * inverseSqrt(1.0 + tangent * tangent);
}

// The two stored azimuths around a direction, and the weight of the second.
struct HorizonShadowSlices {
    first: u32,
    second: u32,
    weight: f32,
    // Whether either is baked; one that is not has no weight.
    baked: bool,
}

fn horizon_shadow_is_baked(parameters: HorizonShadowParameters, azimuth: u32) -> bool {
    let word = select(parameters.baked_azimuths.x, parameters.baked_azimuths.y, azimuth >= 32u);
    return ((word >> (azimuth & 31u)) & 1u) != 0u;
}

fn horizon_shadow_slices(parameters: HorizonShadowParameters, direction: vec2f) -> HorizonShadowSlices {
    let count = f32(parameters.azimuths);
    let turns = atan2(direction.y, direction.x) / (2.0 * SHEEN_PI);
    let position = (turns - floor(turns)) * count;
    let whole = floor(position);
    var slices: HorizonShadowSlices;
    slices.first = u32(select(whole, 0.0, whole >= count));
    slices.second = select(slices.first + 1u, 0u, slices.first + 1u >= parameters.azimuths);
    let first = horizon_shadow_is_baked(parameters, slices.first);
    let second = horizon_shadow_is_baked(parameters, slices.second);
    slices.weight = select(select(0.0, 1.0, second), select(0.0, position - whole, second), first);
    slices.baked = first || second;
    return slices;
}

// Texels of the map that a pixel covers along its longer side.
fn horizon_shadow_footprint(parameters: HorizonShadowParameters, surface: HorizonShadowSurface) -> f32 {
    let scale = parameters.uv_scale * parameters.size;
    let longest = max(length(surface.uv_dx * scale), length(surface.uv_dy * scale));
    return max(horizon_shadow_bounded(longest, 1e6), 0.0);
}
