#include "frame.glsl"
#include "footprint.glsl"

// What varies over an object, from what the vertices around carry and from pictures, for all that the
// pixel covers. Twin of reference/varying.py, whose paths integrate over the pixel instead.
uniform vec3 base_albedo;
uniform float base_roughness;
uniform float base_metallic;
uniform float base_weight;
uniform vec3 dielectric_f0;
uniform vec3 metal_f0;
#ifdef FRESNEL_F82
uniform vec3 dielectric_f82;
uniform vec3 metal_f82;
#endif
uniform WIDTH stretch; // alpha over roughness²
uniform vec2 tangent_turn; // cosine and sine
uniform sampler2D vertex_uv;
uniform sampler2D vertex_tangent; // and its side
uniform sampler2D vertex_albedo;
uniform sampler2D vertex_numbers; // roughness, metallic, weight
uniform sampler2D albedo_map;     // PAIRED: in its mips times 1 - metallic
uniform sampler2D roughness_map;  // r, and in its mips the mean of r⁴
uniform sampler2D metallic_map;   // m, and in its mips the means of m and m²
uniform sampler2D weight_map;
uniform sampler2D normal_map;     // slopes x, y
uniform sampler2D slopes_map;     // in its mips the means of x², y² and x y

vec4 carried(sampler2D values, vec3 weights) {
    vec4 sum = vec4(0.0);
    for (int k = 0; k < 3; ++k) {
        sum += weights[k] * texelFetch(values, row_texel(int(here_vertices[k])), 0);
    }
    return sum;
}

#ifdef TEXTURED
vec3 here_ray;     // through the middle of what is shaded: the pixel, or a part of it
float here_extent; // in pixels

Footprint footprint() {
    uvec3 corner = uvec3(here_vertices[0], here_vertices[1], here_vertices[2]);
    vec3 x = 2.0 * here_extent / picture_size.x * right, y = 2.0 * here_extent / picture_size.y * up;
    vec2 uv = carried(vertex_uv, plane_weights(corner, here_ray)).xy; // unclamped, as its neighbours
    vec2 dx = carried(vertex_uv, plane_weights(corner, here_ray + x)).xy - uv;
    vec2 dy = carried(vertex_uv, plane_weights(corner, here_ray + y)).xy - uv;
    return Footprint(carried(vertex_uv, here_weights).xy, dx, dy);
}

// Whether a picture changes within the footprint: it spans most of a texel, or more.
bool changes_within(Footprint f) {
    vec2 size = vec2(0.0);
#ifdef MAP_ALBEDO
    size = max(size, vec2(textureSize(albedo_map, 0)));
#endif
#ifdef MAP_ROUGHNESS
    size = max(size, vec2(textureSize(roughness_map, 0)));
#endif
#ifdef MAP_METALLIC
    size = max(size, vec2(textureSize(metallic_map, 0)));
#endif
#ifdef MAP_WEIGHT
    size = max(size, vec2(textureSize(weight_map, 0)));
#endif
#ifdef MAP_NORMAL
    size = max(size, vec2(textureSize(normal_map, 0)));
#endif
    return max(length(f.dx * size), length(f.dy * size)) > 0.75;
}

vec4 mean_of(sampler2D map, Footprint f) {
    Taps taps = taps_of(f, vec2(textureSize(map, 0)));
    vec4 sum = vec4(0.0);
    for (int i = 0; i < taps.count; ++i) {
        sum += textureLod(map, taps.first + float(i) * taps.stride, taps.lod);
    }
    return sum / float(taps.count);
}
#endif

// A power of a picture's value is not that power of its mean. So level 0 holds the values and the
// further levels the means of the powers; between 0 and 1 both are mixed.

#ifdef MAP_ROUGHNESS
float fourth_power(vec2 uv, float lod) {
    if (lod >= 1.0) return textureLod(roughness_map, uv, lod).g;
    float r = textureLod(roughness_map, uv, 0.0).r, r2 = r * r;
    return lod == 0.0 ? r2 * r2 : mix(r2 * r2, textureLod(roughness_map, uv, 1.0).g, lod);
}

// Such that its alpha² is the mean: the variance of the facets' slopes.
float mean_roughness(Footprint f) {
    Taps taps = taps_of(f, vec2(textureSize(roughness_map, 0)));
    float sum = 0.0;
    for (int i = 0; i < taps.count; ++i) {
        sum += fourth_power(taps.first + float(i) * taps.stride, taps.lod);
    }
    return sqrt(sqrt(sum / float(taps.count)));
}
#endif

#ifdef MAP_METALLIC
// The means of m and m².
vec2 mean_metallic(Footprint f) {
    Taps taps = taps_of(f, vec2(textureSize(metallic_map, 0)));
    vec2 sum = vec2(0.0);
    for (int i = 0; i < taps.count; ++i) {
        vec2 uv = taps.first + float(i) * taps.stride;
        vec2 m = textureLod(metallic_map, uv, taps.lod).rg;
        if (taps.lod < 1.0) {
            float own = textureLod(metallic_map, uv, 0.0).r;
            m.g = own * own;
            if (taps.lod > 0.0) m.g = mix(m.g, textureLod(metallic_map, uv, 1.0).g, taps.lod);
        }
        sum += m;
    }
    return sum / float(taps.count);
}
#endif

#ifdef PAIRED
// The mean of albedo times 1 - metallic: where one picture is paint and the other says where it is,
// the product of their means is not.
vec3 mean_diffuse(Footprint f) {
    Taps taps = taps_of(f, vec2(textureSize(albedo_map, 0)));
    vec3 sum = vec3(0.0);
    for (int i = 0; i < taps.count; ++i) {
        vec2 uv = taps.first + float(i) * taps.stride;
        vec3 coarse = textureLod(albedo_map, uv, max(taps.lod, 1.0)).rgb;
        if (taps.lod < 1.0) {
            float rest = 1.0 - base_metallic * textureLod(metallic_map, uv, 0.0).r;
            coarse = mix(rest * textureLod(albedo_map, uv, 0.0).rgb, coarse, taps.lod);
        }
        sum += coarse;
    }
    return sum / float(taps.count);
}
#endif

#ifdef MAP_NORMAL
vec3 products(vec2 slopes) {
    return vec3(slopes * slopes, slopes.x * slopes.y);
}

// Mean slopes, and the variances and the covariance of all that the pixel covers: LEAN mapping,
// Olano and Baker 2010.
void mean_slopes(Footprint f, out vec2 mean, out vec3 spread) {
    Taps taps = taps_of(f, vec2(textureSize(normal_map, 0)));
    mean = vec2(0.0);
    vec3 moments = vec3(0.0);
    for (int i = 0; i < taps.count; ++i) {
        vec2 uv = taps.first + float(i) * taps.stride;
        vec2 slopes = textureLod(normal_map, uv, taps.lod).xy;
        mean += slopes;
        if (taps.lod >= 1.0) {
            moments += textureLod(slopes_map, uv, taps.lod).xyz;
        } else if (taps.lod == 0.0) {
            moments += products(slopes);
        } else {
            vec3 own = products(textureLod(normal_map, uv, 0.0).xy);
            moments += mix(own, textureLod(slopes_map, uv, 1.0).xyz, taps.lod);
        }
    }
    mean /= float(taps.count);
    moments /= float(taps.count);
    spread = moments - products(mean);
    // Below that it is rounding.
    if (spread.x + spread.y < 1e-6 * (moments.x + moments.y)) spread = vec3(0.0);
    spread.xy = max(spread.xy, 0.0);
}

#ifdef ANISOTROPIC
// Slopes of variance alpha²/2 (Beckmann's; GGX's wider ones are treated alike) with others' added to
// them: turns the tangent t into the direction in which they vary most.
void widen(inout Material m, vec3 spread, vec3 n, inout vec3 t) {
    vec2 own = m.alpha * m.alpha;
    vec2 S = own + 2.0 * spread.xy;
    float covariance = 2.0 * spread.z;
    float middle = 0.5 * (S.x + S.y), half_gap = 0.5 * (S.x - S.y);
    float radius = length(vec2(half_gap, covariance));
    float angle = radius > 0.0 ? 0.5 * atan(covariance, half_gap) : 0.0;
    float c = cos(angle), s = sin(angle);
    t = c * t + s * cross(n, t);
    vec2 facets = vec2(c * c * own.x + s * s * own.y, s * s * own.x + c * c * own.y);
    m.facet_alpha = sqrt(facets);
    float least = min(own.x, own.y); // what is added is no less than 0 in any direction
    vec2 alpha2 = max(vec2(middle + radius, middle - radius), least);
    m.alpha = sqrt(alpha2);
    m.lean = max(1.0 - facets / alpha2, 0.0);
}
#endif
#endif

// Gives m, n and the tangent their values here.
void vary(inout Material m, inout vec3 n) {
    vec3 colour = base_albedo;
    float roughness = base_roughness, metallic = base_metallic;
#ifdef TEXTURED
    Footprint f = footprint();
#endif
#ifdef VERTEX_NUMBERS
    vec3 numbers = carried(vertex_numbers, here_weights).xyz;
    roughness *= numbers.x;
    metallic *= numbers.y;
#endif
#ifdef VERTEX_ALBEDO
    colour *= carried(vertex_albedo, here_weights).rgb;
#endif
#if defined(MAP_ALBEDO) && !defined(PAIRED)
    colour *= mean_of(albedo_map, f).rgb;
#endif
#ifdef MAP_ROUGHNESS
    roughness *= mean_roughness(f);
#endif
#ifdef MAP_METALLIC
    vec2 moments = mean_metallic(f);
    float spare = metallic * metallic * (moments.y - moments.x * moments.x); // variance of metallic
    metallic *= moments.x;
#endif
#ifdef PAIRED
    m.albedo = colour * mean_diffuse(f);
#else
    m.albedo = colour * (1.0 - metallic);
#endif
    m.f0 = mix(dielectric_f0, metal_f0, metallic);
#ifdef FRESNEL_F82
    m.f82 = mix(dielectric_f82, metal_f82, metallic);
#endif
#if defined(FRESNEL_METAL) || defined(FRESNEL_DIELECTRIC)
    m.metallic = metallic;
#endif
    m.alpha = max(roughness * roughness * stretch, 1e-4);
#ifdef MAP_METALLIC
    // Where metal and dielectric share a pixel, light passes into the dielectric by its own F alone:
    // the mean of (1 - m) (1 - F0(m)), and not the product of their means.
    m.albedo *= 1.0 + spare * (metal_f0 - dielectric_f0) / max((1.0 - m.f0) * (1.0 - metallic), 1e-6);
#endif
#ifdef VARIES_WEIGHT
    float weight = base_weight;
#ifdef VERTEX_NUMBERS
    weight *= numbers.z;
#endif
#ifdef MAP_WEIGHT
    weight *= mean_of(weight_map, f).r;
#endif
    m.weight_d = vec2(weight, 1.0 - weight);
#ifdef MASKING_FOLLOWS
    m.weight_g = m.weight_d;
#endif
#endif
#ifdef DIRECTED
    vec4 found = carried(vertex_tangent, here_weights);
    vec3 t = found.xyz - n * dot(n, found.xyz);
    t = dot(t, t) > 1e-12 ? normalize(t) : tangent_frame(n)[0];
#ifdef MAP_NORMAL
    vec2 slopes;
    vec3 spread;
    mean_slopes(f, slopes, spread);
    float steep = 1.0 + dot(slopes, slopes);
    m.upright = sqrt(steep / (steep + spread.x + spread.y));
    float side = found.w < 0.0 ? -1.0 : 1.0;
    n = normalize(slopes.x * t + slopes.y * side * cross(n, t) + n);
    t = normalize(t - n * dot(n, t));
    spread.z *= side; // the slopes are along t and side cross(n, t)
#endif
    t = tangent_turn.x * t + tangent_turn.y * cross(n, t);
#ifdef ANISOTROPIC
#ifdef MAP_NORMAL
    // The covariance in the turned tangent's frame.
    float c = tangent_turn.x, s = tangent_turn.y, cs = c * s;
    spread = vec3(
        c * c * spread.x + s * s * spread.y + 2.0 * cs * spread.z,
        s * s * spread.x + c * c * spread.y - 2.0 * cs * spread.z,
        cs * (spread.y - spread.x) + (c * c - s * s) * spread.z);
    widen(m, spread, n, t);
#endif
    here_tangent = t;
#elif defined(MAP_NORMAL)
    m.alpha = sqrt(m.alpha * m.alpha + spread.x + spread.y);
#endif
#endif
}
