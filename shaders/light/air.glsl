// Air along a ray, the mirror of libshape/light/air.c (see shape/air.h). Before it: sun_direction.
uniform float air_extinction; // at the eye [1/m]
uniform float air_thinning;   // by how much it falls a metre higher, of itself [1/m]; 0: alike at all heights
uniform vec3 air_ball;        // the middle of all that throws shadows, relative to the eye
uniform float air_radius;     // of the ball around it [m]

float air_rate;      // air_thinning along the loaded ray
float air_t0, air_t1; // where shadow can be
float air_curve;     // the air's depth there, which slices are spread by

float air_depth(float t)
{
    float x = air_rate * t;
    if (abs(x) < 1e-3)
        return air_extinction * t * (1.0 - 0.5 * x);
    return air_extinction * (1.0 - exp(-max(x, -80.0))) / air_rate;
}

// Shadow lies in the ball and behind it, seen from the sun: a half cylinder. Beyond a depth of 7, a thousandth of the light
// comes from, nobody looks.
void air_load(vec3 ray)
{
    air_rate = air_thinning * ray.y;
    float along = dot(ray, sun_direction), ahead = dot(air_ball, sun_direction);
    float a = max(1.0 - along * along, 1e-6), b = dot(ray, air_ball) - along * ahead;
    float c = dot(air_ball, air_ball) - ahead * ahead - air_radius * air_radius, room = b * b - a * c;
    float root = sqrt(max(room, 0.0)), cap = (ahead + air_radius) / (abs(along) > 1e-6 ? along : 1e-6);
    air_t0 = max((b - root) / a, 0.0);
    air_t1 = (b + root) / a;
    if (along > 1e-6)
        air_t1 = min(air_t1, cap);
    if (along < -1e-6)
        air_t0 = max(air_t0, cap);
    float x = 7.0 * air_rate / air_extinction;
    air_t1 = min(air_t1, abs(x) < 1e-3 ? 7.0 / air_extinction : x < 1.0 ? -log(1.0 - x) / air_rate : 1e9);
    if (room < 0.0 || air_t1 < air_t0)
        air_t1 = air_t0;
    air_curve = clamp(air_depth(air_t1) - air_depth(air_t0), 0.0, 7.0);
}

// Where slice x begins, 0 to 1 over all of them, and the reverse: equal slices hold about equal shares of the air's light.
float air_place(float x)
{
    float share = air_curve < 1e-2 ? x : -log(1.0 - x * (1.0 - exp(-air_curve))) / air_curve;
    return air_t0 + (air_t1 - air_t0) * share;
}

float air_slice(float t)
{
    float share = clamp((t - air_t0) / max(air_t1 - air_t0, 1e-9), 0.0, 1.0);
    return air_curve < 1e-2 ? share : (1.0 - exp(-air_curve * share)) / (1.0 - exp(-air_curve));
}
