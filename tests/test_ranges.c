/* The ranges that the headers state: each member of each struct of options is taken at both ends of its range, and refused
 * beyond them and as a NaN, with its name in the error. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "shape/gaussian.h"
#include "shape/layer.h"
#include "shape/march.h"
#include "shape/meshfit.h"
#include "shape/metaball.h"
#include "shape/motion.h"
#include "shape/paper.h"
#include "shape/refine.h"
#include "shape/scatter.h"
#include "shape/simplify.h"
#include "shape/transform.h"
#include "shape/volumefit.h"

typedef enum kind { A_DOUBLE, A_FLOAT, AN_INT, A_SIZE } kind;

/* A member: what is just refused below, the least and the most that are taken, what is just refused above. A whole number
 * that cannot be refused below has below = least. */
typedef struct range {
    const char *word; /* in the error */
    size_t at;
    kind kind;
    double below, least, most, above;
} range;

typedef shape_status (*checker)(const void *options, shape_error *error);

static void put(void *options, const range *r, double value)
{
    char *at = (char *)options + r->at;
    const float single = (float)value;
    const int whole = r->kind == AN_INT ? (int)value : 0;
    const size_t size = r->kind == A_SIZE ? (size_t)value : 0;
    if (r->kind == A_DOUBLE)
        memcpy(at, &value, sizeof value);
    else if (r->kind == A_FLOAT)
        memcpy(at, &single, sizeof single);
    else if (r->kind == AN_INT)
        memcpy(at, &whole, sizeof whole);
    else
        memcpy(at, &size, sizeof size);
}

static void expect(checker check, const void *options, const range *r, double value, bool good)
{
    shape_error error = {.text = ""};
    shape_status status = check(options, &error);
    if (status != (good ? SHAPE_OK : SHAPE_ERROR_ARGUMENT))
        fail_msg("%s %.17g: status %d, \"%s\"", r->word, value, (int)status, error.text);
    if (!good && !strstr(error.text, r->word))
        fail_msg("%s %.17g: \"%s\" does not name it", r->word, value, error.text);
}

/* Each range in its turn, the other members as they were. */
static void check_ranges(checker check, const void *defaults, size_t size, const range *ranges, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        const range *r = &ranges[i];
        const struct {
            double value;
            bool good;
        } tries[] = {{r->least, true},
                     {r->most, true},
                     {r->below, r->below == r->least},
                     {r->above, false},
                     {NAN, false}};
        bool whole = r->kind == AN_INT || r->kind == A_SIZE;
        for (size_t k = 0; k < (whole ? 4 : 5); k++) {
            double changed[128]; /* aligned for any of them */
            assert_true(size <= sizeof changed);
            memcpy(changed, defaults, size);
            put(changed, r, tries[k].value);
            expect(check, changed, r, tries[k].value, tries[k].good);
        }
    }
}

#define CHECK(name)                                                                                          \
    static shape_status check_##name(const void *options, shape_error *error)                                \
    {                                                                                                        \
        return shape_##name##_check(options, error);                                                         \
    }
#define COUNT(array) (sizeof(array) / sizeof *(array))
#define RANGES(name, defaults, ranges)                                                                       \
    check_ranges(check_##name, &(defaults), sizeof(defaults), ranges, COUNT(ranges))

/* --- pictures --- */

CHECK(march)
CHECK(view)
CHECK(light)
CHECK(lamp)
CHECK(paper)
CHECK(pathtrace)

static void test_march(void **state)
{
    (void)state;
    shape_march_options options = shape_march_defaults();
    options.light = SHAPE_MARCH_SINGLE; /* which goes with every other choice */
#define M(member) #member, offsetof(shape_march_options, member)
    static const range ranges[] = {
        {M(rule), AN_INT, SHAPE_RULE_RIEMANN_LEFT, SHAPE_RULE_RIEMANN_LEFT, SHAPE_RULE_EXPONENTIAL,
         SHAPE_RULE_EXPONENTIAL + 1},
        {M(light), AN_INT, SHAPE_MARCH_SINGLE, SHAPE_MARCH_SINGLE, SHAPE_MARCH_GRID, SHAPE_MARCH_GRID + 1},
        {M(shadow), AN_INT, SHAPE_SHADOW_MARCH, SHAPE_SHADOW_MARCH, SHAPE_SHADOW_GRID, SHAPE_SHADOW_GRID + 1},
        {M(stepping), AN_INT, SHAPE_STEP_FIXED, SHAPE_STEP_FIXED, SHAPE_STEP_EXPONENTIAL,
         SHAPE_STEP_EXPONENTIAL + 1},
        {M(jitter), AN_INT, SHAPE_JITTER_NONE, SHAPE_JITTER_NONE, SHAPE_JITTER_BLUE, SHAPE_JITTER_BLUE + 1},
        {M(end), AN_INT, SHAPE_END_CUT, SHAPE_END_CUT, SHAPE_END_ADAPT, SHAPE_END_ADAPT + 1},
        {M(step), A_DOUBLE, -1e-300, 0, 999999999, 1e9},
        {M(light_step), A_DOUBLE, -1e-300, 0, 999999999, 1e9},
        {M(growth), A_DOUBLE, 0.999999, 1, 2, 2.000001},
        {M(share), A_DOUBLE, 0, 1e-300, 1, 1.000001},
        {M(resolution), AN_INT, 1, 2, 256, 257},
        {M(samples), AN_INT, 0, 1, 4096, 4097},
        {M(powder), A_DOUBLE, -1e-300, 0, 1000, 1000.001},
        {M(octaves), AN_INT, 0, 1, SHAPE_MARCH_OCTAVES_MAX, SHAPE_MARCH_OCTAVES_MAX + 1},
        {M(shade), A_DOUBLE, -1e-300, 0, 1, 1.000001},
        {M(forward), A_DOUBLE, -1e-300, 0, 1, 1.000001},
        {"emission", offsetof(shape_march_options, emission[1]), A_FLOAT, -1e-30, 0, 1e9, 1.001e9},
        {"ambient", offsetof(shape_march_options, ambient[2]), A_FLOAT, -1e-30, 0, 1e9, 1.001e9},
        {M(lock), A_DOUBLE, -1e-300, 0, 1e9, 1.001e9},
        {M(cutoff), A_DOUBLE, 0.999e-12, 1e-12, 0.1, 0.1001},
        {M(alpha_power), A_DOUBLE, 0.00999, 0.01, 100, 100.01},
        {M(alpha_peel), A_DOUBLE, -1e-300, 0, 1, 1.000001}};
    RANGES(march, options, ranges);
}

static shape_status check_march_of(shape_march_light light, bool silver, bool lamp, shape_error *error)
{
    shape_march_options options = shape_march_defaults();
    options.light = light;
    options.silver = silver;
    options.lamp.intensity[1] = lamp ? 1 : 0;
    return shape_march_check(&options, error);
}

static void test_march_choices_together(void **state)
{
    (void)state;
    shape_error error;
    for (int light = SHAPE_MARCH_SINGLE; light <= SHAPE_MARCH_GRID; light++) {
        bool own_phase = light == SHAPE_MARCH_GRID || light == SHAPE_MARCH_OCTAVES;
        bool sun_alone =
            light == SHAPE_MARCH_GRID || light == SHAPE_MARCH_OCTAVES || light == SHAPE_MARCH_TWO_PASS;
        assert_int_equal(check_march_of((shape_march_light)light, true, false, &error) != SHAPE_OK,
                         own_phase);
        if (own_phase)
            assert_non_null(strstr(error.text, "silver"));
        bool takes = shape_march_takes_lamp((shape_march_light)light, SHAPE_SHADOW_MARCH);
        assert_true(sun_alone || takes);
        assert_int_equal(check_march_of((shape_march_light)light, false, true, &error) == SHAPE_OK, takes);
    }
}

static void test_view_and_light(void **state)
{
    (void)state;
    shape_view view = shape_view_defaults();
#define V(word, member) word, offsetof(shape_view, member)
    static const range views[] = {{V("size", width), AN_INT, 0, 1, 16384, 16385},
                                  {V("size", height), AN_INT, 0, 1, 16384, 16385},
                                  {V("fov", fov), A_DOUBLE, 0, 1e-6, 179.999, 180},
                                  {V("eye", eye.x), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {V("eye", eye.y), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {V("eye", eye.z), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {V("target", target.x), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {V("target", target.y), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {V("target", target.z), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {V("exposure", exposure), A_FLOAT, -INFINITY, -30, 30, INFINITY}};
    RANGES(view, view, views);
    shape_light light = shape_light_defaults();
#define L(word, member) word, offsetof(shape_light, member)
    static const range lights[] = {
        {L("sun", sun.x), A_DOUBLE, -3, 0.6634, 0.6634, 3}, /* of a unit vector: nothing else fits */
        {L("sky", sky), AN_INT, SHAPE_SKY_NONE, SHAPE_SKY_NONE, SHAPE_SKY_CLEAR, SHAPE_SKY_CLEAR + 1},
        {L("sun_irradiance", sun_irradiance[1]), A_FLOAT, -1e-30, 0, 1e30, INFINITY},
        {L("sky_radiance", sky_radiance[2]), A_FLOAT, -1e-30, 0, 1e30, INFINITY},
        {L("visibility", air.visibility), A_DOUBLE, 0.999e-3, 1e-3, 1e12, 1.001e12},
        {L("height", air.height), A_DOUBLE, 0.999e-3, 1e-3, 1e12, 1.001e12}};
    light.sun = shape_dvec3_make(0.6634, sqrt(1 - 0.6634 * 0.6634), 0);
    RANGES(light, light, lights);
    shape_lamp lamp = {.intensity = {0, 1, 0}};
#define LA(word, member) word, offsetof(shape_lamp, member)
    static const range lamps[] = {{LA("intensity", intensity[0]), A_FLOAT, -1e-30, 0, 1e30, INFINITY},
                                  {LA("intensity", intensity[2]), A_FLOAT, -1e-30, 0, 1e30, INFINITY},
                                  {LA("position", position.x), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {LA("position", position.y), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY},
                                  {LA("position", position.z), A_DOUBLE, -INFINITY, -1e9, 1e9, INFINITY}};
    RANGES(lamp, lamp, lamps);
    for (int c = 0; c < 3; c++) {
        shape_lamp one = {.intensity = {0, 0, 0}};
        assert_false(shape_lamp_shines(&one));
        one.intensity[c] = 1e-9f;
        assert_true(shape_lamp_shines(&one));
    }
}

static void test_paper_and_paths(void **state)
{
    (void)state;
    shape_paper_options paper = shape_paper_defaults();
    static const range papers[] = {
        {"resolution", offsetof(shape_paper_options, resolution), AN_INT, 1, 2, 256, 257},
        {"samples", offsetof(shape_paper_options, samples), AN_INT, 0, 1, 4096, 4097}};
    RANGES(paper, paper, papers);
    shape_pathtrace_pixel pixel;
    shape_pathtrace_options paths = shape_pathtrace_defaults();
    paths.pixels = &pixel;
#define P(member) #member, offsetof(shape_pathtrace_options, member)
    static const range ranges[] = {{P(samples), AN_INT, 0, 1, 1 << 20, (1 << 20) + 1},
                                   {P(max_bounces), AN_INT, -1, 0, 1 << 20, (1 << 20) + 1},
                                   {P(sun_angle), A_DOUBLE, -1e-300, 0, 90, 90.001},
                                   {P(samples_before), AN_INT, -1, 0, 64, 65}};
    RANGES(pathtrace, paths, ranges);
    shape_error error;
    paths.noise = -1e-9;
    assert_int_equal(shape_pathtrace_check(&paths, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "noise"));
    paths.noise = 0;
    paths.samples_before = 1;
    paths.pixels = NULL; /* of which there would be samples */
    assert_int_equal(shape_pathtrace_check(&paths, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, "with their pixels"));
}

/* --- shapes --- */

CHECK(gaussian)
CHECK(metaball)
CHECK(layer_options)
CHECK(meshfit)
CHECK(volumefit)
CHECK(simplify)
CHECK(grow)
CHECK(clip)
CHECK(transform)
CHECK(motion)

static void test_generators(void **state)
{
    (void)state;
    shape_gaussian gaussian = shape_gaussian_defaults();
#define G(word, member) word, offsetof(shape_gaussian, member)
    static const range gaussians[] = {{G("count", count), A_SIZE, 0, 1, 10000000, 10000001},
                                      {G("mean x", mean[0]), A_DOUBLE, -1.001e6, -1e6, 1e6, 1.001e6},
                                      {G("sigma z", sigma[2]), A_DOUBLE, -1e-300, 0, 1e6, 1.001e6},
                                      {G("clamp", clamp), A_DOUBLE, 0.00999, 0.01, 10, 10.01},
                                      {G("clamp mode", clamp_mode), AN_INT, 0, 0, 1, 2},
                                      {G("radius law", radius_law), AN_INT, 0, 0, 1, 2},
                                      {G("max-radius", max_radius), A_DOUBLE, 0.999e-6, 1e-6, 1e6, 1.001e6}};
    RANGES(gaussian, gaussian, gaussians);
    shape_metaball metaball = shape_metaball_defaults();
#define B(word, member) word, offsetof(shape_metaball, member)
    static const range metaballs[] = {{B("count", count), A_SIZE, 0, 1, 100000, 100001},
                                      {B("sigma y", sigma[1]), A_DOUBLE, -1e-300, 0, 1e6, 1.001e6},
                                      {B("max-radius", max_radius), A_DOUBLE, 0, 1.25, 1e6, 1.001e6},
                                      {B("min-radius", min_radius), A_DOUBLE, 0.999e-6, 1e-6, 2.5, 2.501}};
    RANGES(metaball, metaball, metaballs);
    shape_layer_options layer = shape_layer_options_defaults();
#define Y(word, member) word, offsetof(shape_layer_options, member)
    static const range layers[] = {{Y("extent", extent[1]), A_DOUBLE, 0.999e-3, 1e-3, 1e8, 1.001e8},
                                   {Y("base", base), A_DOUBLE, -1.001e8, -1e8, 1e8, 1.001e8},
                                   {Y("extinction", extinction), A_DOUBLE, -1e-300, 0, 1e9, 1.001e9}};
    RANGES(layer_options, layer, layers);
    layer.layer.bounds = SHAPE_BOUNDS_ALTITUDES;
    static const range planet[] = {{Y("planet-radius", planet_radius), A_DOUBLE, -1e-300, 0, 1e8, 1.001e8}};
    RANGES(layer_options, layer, planet);
}

static void test_fits(void **state)
{
    (void)state;
    shape_meshfit mesh = shape_meshfit_defaults();
#define F(member) #member, offsetof(shape_meshfit, member)
    static const range meshes[] = {{F(scale), A_DOUBLE, 0, 1e-300, 100, 100.001},
                                   {F(thickness), A_DOUBLE, 0.000999, 0.001, 10, 10.001},
                                   {"fit", offsetof(shape_meshfit, kind), AN_INT, SHAPE_MESHFIT_PAPER,
                                    SHAPE_MESHFIT_PAPER, SHAPE_MESHFIT_PLANE, SHAPE_MESHFIT_PLANE + 1}};
    RANGES(meshfit, mesh, meshes);
    shape_volumefit_options volume = shape_volumefit_defaults();
#define O(word, member) word, offsetof(shape_volumefit_options, member)
    static const range volumes[] = {{O("primitives", primitives), A_SIZE, 0, 1,
                                     SHAPE_VOLUMEFIT_MAX_PRIMITIVES, SHAPE_VOLUMEFIT_MAX_PRIMITIVES + 1.0},
                                    {O("error", error), A_DOUBLE, -1e-300, 0, 1e30, INFINITY},
                                    {O("cells", resolution), AN_INT, 15, 16, 512, 513},
                                    {O("rounds", rounds), AN_INT, -1, 0, 10000, 10001},
                                    {O("model", model), AN_INT, SHAPE_MODEL_UNIFORM, SHAPE_MODEL_UNIFORM,
                                     SHAPE_MODEL_SPHEROID, SHAPE_MODEL_GRID}};
    RANGES(volumefit, volume, volumes);
    shape_simplify_options simplify = shape_simplify_defaults();
    static const range simplifies[] = {
        {"error", offsetof(shape_simplify_options, error), A_DOUBLE, -1, -1, 1, 1.001},
        {"resolution", offsetof(shape_simplify_options, resolution), AN_INT, 7, 8, 256, 257}};
    RANGES(simplify, simplify, simplifies);
}

static void test_edits(void **state)
{
    (void)state;
    shape_grow grow = shape_grow_defaults();
    grow.ratio[0] = 0.2;
    grow.ratio[1] = 0.5;
#define W(word, member) word, offsetof(shape_grow, member)
    static const range grows[] = {{W("grow-levels", levels), AN_INT, 0, 1, 8, 9},
                                  {W("grow-count", count), AN_INT, 0, 1, 1000, 1001},
                                  {W("lower grow-ratio", ratio[0]), A_DOUBLE, 0.00999, 0.01, 0.5, 1.001},
                                  {W("upper grow-ratio", ratio[1]), A_DOUBLE, 0.199, 0.2, 1, 1.001}};
    RANGES(grow, grow, grows);
    shape_clip clip = shape_clip_defaults();
#define C(word, member) word, offsetof(shape_clip, member)
    static const range clips[] = {{C("clip-normal", normal[0]), A_DOUBLE, -1.001e6, -1e6, 1e6, 1.001e6},
                                  {C("length of clip-normal", normal[1]), A_DOUBLE, 0, 1e-6, 1, 0},
                                  {C("clip-height", height), A_DOUBLE, -1.001e12, -1e12, 1e12, 1.001e12},
                                  {C("clip-noise", noise), A_DOUBLE, -1e-300, 0, 1e6, 1.001e6},
                                  {C("clip-size", noise_size), A_DOUBLE, 0.999e-6, 1e-6, 1e9, 1.001e9}};
    check_ranges(check_clip, &clip, sizeof clip, &clips[0], 1);
    check_ranges(check_clip, &clip, sizeof clip, &clips[2], COUNT(clips) - 2);
    shape_error error;
    clip.normal[1] = 1e-7;
    assert_int_equal(shape_clip_check(&clip, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, clips[1].word));
    shape_transform transform = shape_transform_defaults();
#define T(word, member) word, offsetof(shape_transform, member)
    static const range transforms[] = {
        {T("scale", scale[1]), A_DOUBLE, 0.999e-6, 1e-6, 1e6, 1.001e6},
        {T("rotation", rotate[2]), A_DOUBLE, -1.001e6, -1e6, 1e6, 1.001e6},
        {T("translation", translate[0]), A_DOUBLE, -1.001e12, -1e12, 1e12, 1.001e12},
        {T("pivot", pivot[2]), A_DOUBLE, -1.001e12, -1e12, 1e12, 1.001e12}};
    RANGES(transform, transform, transforms);
}

static void test_motion(void **state)
{
    (void)state;
    shape_motion motion = {.seed = 1};
#define N(word, member) word, offsetof(shape_motion, member)
    static const range motions[] = {{N("wind", wind[0]), A_DOUBLE, -1000.1, -1000, 1000, 1000.1},
                                    {N("drift", drift[1]), A_DOUBLE, -1000.1, -1000, 1000, 1000.1},
                                    {N("shear", shear), A_DOUBLE, -10.1, -10, 10, 10.1},
                                    {N("life", life), A_DOUBLE, 0.999e-3, 1e-3, 1e9, 1.001e9},
                                    {N("grow", grow), A_DOUBLE, -1e-300, 0, 1e9, 1.001e9},
                                    {N("decay_start", decay_start), A_DOUBLE, -1.001e9, -1e9, 1e9, 1.001e9},
                                    {N("decay", decay), A_DOUBLE, -1e-300, 0, 1e9, 1.001e9}};
    RANGES(motion, motion, motions);
    /* One that is not 0 is enough for something to move; when decay would start is not. */
    static const struct {
        size_t at;
        bool moves;
    } members[] = {{offsetof(shape_motion, wind[0]), true},     {offsetof(shape_motion, wind[1]), true},
                   {offsetof(shape_motion, wind[2]), true},     {offsetof(shape_motion, drift[0]), true},
                   {offsetof(shape_motion, drift[1]), true},    {offsetof(shape_motion, drift[2]), true},
                   {offsetof(shape_motion, shear), true},       {offsetof(shape_motion, life), true},
                   {offsetof(shape_motion, grow), true},        {offsetof(shape_motion, decay), true},
                   {offsetof(shape_motion, decay_start), false}};
    for (size_t i = 0; i < COUNT(members); i++) {
        const double one = 1;
        memset(&motion, 0, sizeof motion);
        assert_false(shape_motion_is_on(&motion));
        memcpy((char *)&motion + members[i].at, &one, sizeof one);
        assert_int_equal(shape_motion_is_on(&motion), members[i].moves);
    }
}

static void refuse_scatter(size_t count, double width, double depth, const char *words)
{
    shape_point2 points[4];
    shape_error error = {.text = ""};
    assert_int_equal(shape_scatter(count, width, depth, 1, points, NULL, &error), SHAPE_ERROR_ARGUMENT);
    assert_non_null(strstr(error.text, words));
}

static void test_scatter(void **state)
{
    (void)state;
    refuse_scatter(0, 1, 1, "0 points");
    refuse_scatter(SHAPE_SCATTER_MAX + (size_t)1, 1, 1, "points");
    refuse_scatter(1, 0.999e-3, 1, "area");
    refuse_scatter(1, 1.001e9, 1, "area");
    refuse_scatter(1, 1, 0.999e-3, "area");
    refuse_scatter(1, 1, 1.001e9, "area");
    refuse_scatter(1, NAN, 1, "area");
    refuse_scatter(1, 1, NAN, "area");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_march),          cmocka_unit_test(test_march_choices_together),
        cmocka_unit_test(test_view_and_light), cmocka_unit_test(test_paper_and_paths),
        cmocka_unit_test(test_generators),     cmocka_unit_test(test_fits),
        cmocka_unit_test(test_edits),          cmocka_unit_test(test_motion),
        cmocka_unit_test(test_scatter)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
