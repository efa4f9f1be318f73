/* Scenes: what is read is what stands there, what is written reads back equal, and every mistake is told with its place. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "file/scene_private.h"
#include "shape/scene.h"

static shape_scene *read_good(const char *text)
{
    shape_error error = {SHAPE_OK, ""};
    shape_scene *scene = NULL;
    if (shape_scene_decode(text, strlen(text), "s.json", &scene, &error))
        fail_msg("%s", error.text);
    return scene;
}

static void must_refuse(const char *text, const char *said)
{
    shape_error error = {SHAPE_OK, ""};
    shape_scene *scene = NULL;
    shape_status status = shape_scene_decode(text, strlen(text), "s.json", &scene, &error);
    if (!status)
        fail_msg("read without an error: %s", text);
    if (!strstr(error.text, said))
        fail_msg("\"%s\" does not say \"%s\"", error.text, said);
    assert_null(strchr(error.text, '\n'));
    assert_null(scene);
}

#define CLOUDS "{\"scene\": 1, \"clouds\": ["
#define HEAD CLOUDS "], "

static const char *const everything =
    "{\"scene\": 1, \"note\": \"two\\nlines\", \"clouds\": ["
    "{\"file\": \"a.neph\", \"name\": \"sheep\", \"medium\": {\"g\": 0.5, \"note\": \"x\"}, "
    "\"copies\": [{\"translate\": [1, 2.5, -3]}, {\"scale\": [1, 2, 3], \"note\": \"y\"}, {\"mirror\": "
    "\"zx\"}]}, "
    "{\"generator\": \"neph-lsys\", \"input\": \"b.lsys\", \"options\": {\"angle\": \"50..100\", "
    "\"no-hollow\": true, \"sigma\": [5, 2.25, 1e-7], \"seed\": \"18446744073709551615\", \"count\": 40}, "
    "\"translate\": [1, 2, 3], \"rotate\": [10, 20, 30], \"scale\": 2, \"keep-depth\": true}], "
    "\"meshes\": [{\"file\": \"rock.obj\", \"note\": \"grey\"}, {\"file\": \"hill.ply\", \"up\": \"y\", "
    "\"unit\": 0.01, \"albedo\": [0.2, 0.3, 0.1], \"translate\": [1, -2, 3], \"rotate\": [0, 45, 0], "
    "\"scale\": [1, 2, 1], \"mirror\": \"x\"}, {\"file\": \"b.glb\", \"albedo\": 0.8, \"up\": \"z\"}], "
    "\"medium\": {\"albedo\": 0.9}, "
    "\"sun\": {\"azimuth\": 100, \"height\": -2.5, \"irradiance\": 3, \"angle\": 1, "
    "\"day\": {\"hour\": 9.5, \"declination\": -3}}, "
    "\"lamp\": {\"position\": [0, 5, 0], \"intensity\": [100, 50, 25]}, \"sky\": [0.1, 0.2, 0.3], "
    "\"camera\": {\"eye\": [0, 0, 5], \"target\": [0, 1, 0], \"fov\": 30, \"size\": [64, 36]}, "
    "\"exposure\": -0.5, \"ground\": {\"height\": -2, \"albedo\": [0.1, 0.2, 0.3]}, "
    "\"edits\": [{\"cloud\": \"sheep-2\", \"medium\": {\"g\": 0.25}, \"translate\": [1, 2, 3], "
    "\"rotate\": [0, 90, 0], \"scale\": 0.5}, {\"cloud\": \"sheep\", \"hidden\": true, \"note\": \"z\"}], "
    "\"view\": {\"method\": \"exact\", \"split\": true, \"wind\": [1, 0, 0.5]}, \"compare\": \"b.neph\"}";

static void check_option(const shape_scene_option *option, const char *name, const char *text)
{
    assert_string_equal(option->name, name);
    if (text)
        assert_string_equal(option->text, text);
    else
        assert_null(option->text);
}

static void all_keys_are_read(void **state)
{
    (void)state;
    shape_scene *scene = read_good(everything);
    assert_int_equal(scene->cloud_count, 2);
    assert_string_equal(scene->note, "two\nlines");
    const shape_scene_cloud *sheep = &scene->clouds[0], *grown = &scene->clouds[1];
    assert_string_equal(sheep->file, "a.neph");
    assert_string_equal(sheep->name, "sheep");
    assert_int_equal(sheep->copy_count, 3);
    assert_true(sheep->copies[0].translate[1] == 2.5 && sheep->copies[0].scale[2] == 1);
    assert_true(sheep->copies[1].scale[0] == 1 && sheep->copies[1].scale[2] == 3);
    assert_true(sheep->copies[2].mirror[0] && !sheep->copies[2].mirror[1] && sheep->copies[2].mirror[2]);
    assert_int_equal(sheep->medium.count, 1);
    check_option(&sheep->medium.items[0], "g", "0.5");
    assert_string_equal(grown->generator, "neph-lsys");
    assert_string_equal(grown->input, "b.lsys");
    assert_int_equal(grown->options.count, 5); /* in the order written: provenance lines depend on it */
    check_option(&grown->options.items[0], "angle", "50..100");
    check_option(&grown->options.items[1], "no-hollow", NULL);
    check_option(&grown->options.items[2], "sigma", "5,2.25,1e-07");
    check_option(&grown->options.items[3], "seed", "18446744073709551615");
    check_option(&grown->options.items[4], "count", "40");
    assert_true(grown->place.scale[1] == 2 && grown->place.rotate[2] == 30 && grown->place.keep_depth);
    assert_int_equal(scene->mesh_count, 3);
    const shape_scene_mesh *rock = &scene->meshes[0], *hill = &scene->meshes[1];
    assert_string_equal(rock->file, "rock.obj");
    assert_string_equal(rock->note, "grey");
    assert_true(rock->up == SHAPE_SCENE_UP_FORMAT && rock->unit == 1 && rock->albedo[2] == 0.5);
    assert_true(hill->up == SHAPE_SCENE_UP_Y && hill->unit == 0.01 && hill->albedo[1] == 0.3);
    assert_true(hill->place.translate[1] == -2 && hill->place.rotate[1] == 45 && hill->place.scale[1] == 2);
    assert_true(hill->place.mirror[0] && !hill->place.mirror[1]);
    assert_true(scene->meshes[2].up == SHAPE_SCENE_UP_Z && scene->meshes[2].albedo[1] == 0.8);
    assert_true(scene->sun_given && scene->sun[0] == 100 && scene->sun[1] == -2.5);
    assert_true(scene->sun_irradiance[2] == 3 && scene->sun_angle == 1);
    assert_true(scene->day_given && scene->day.hour == 9.5 && scene->day.latitude == 50 &&
                scene->day.declination == -3);
    assert_true(scene->lamp_given && scene->lamp[1] == 5 && scene->lamp_intensity[2] == 25);
    assert_true(scene->sky == SHAPE_SKY_CONSTANT && scene->sky_radiance[1] == 0.2);
    assert_true(scene->eye[2] == 5 && scene->target[1] == 1 && scene->fov == 30 && scene->size[1] == 36);
    assert_true(scene->exposure_given && scene->exposure == -0.5);
    assert_true(scene->ground_given && scene->ground == -2 && scene->ground_albedo[2] == 0.3);
    assert_int_equal(scene->edit_count, 2);
    const shape_scene_edit *moved = &scene->edits[0], *gone = &scene->edits[1];
    assert_string_equal(moved->cloud, "sheep-2");
    check_option(&moved->medium.items[0], "g", "0.25");
    assert_true(moved->translate[2] == 3 && moved->rotate[1] == 90 && moved->scale == 0.5 && !moved->hidden);
    assert_true(gone->hidden && gone->scale == 1 && !strcmp(gone->note, "z"));
    assert_string_equal(shape_scene_find_option(&scene->view, "method"), "exact");
    assert_string_equal(shape_scene_find_option(&scene->view, "wind"), "1,0,0.5");
    assert_null(shape_scene_find_option(&scene->view, "split"));
    assert_string_equal(scene->compare, "b.neph");
    shape_scene_destroy(scene);
}

/* Where points of a mesh's file come to stand, worked out by hand: axes, then unit, then scale, turn and way. */
static void meshes_stand_where_they_are_put(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool z_up; /* of the format */
        double from[3], to[3];
    } all[] = {
        {"", false, {1, 2, 3}, {1, 2, 3}},
        {"", true, {1, 2, 3}, {1, 3, -2}},
        {", \"up\": \"y\"", true, {1, 2, 3}, {1, 2, 3}},
        {", \"up\": \"z\", \"unit\": 10", false, {1, 2, 3}, {10, 30, -20}},
        {", \"scale\": [1, 2, 4], \"translate\": [100, 0, 0]", false, {1, 2, 3}, {101, 4, 12}},
        {", \"unit\": 0.5, \"rotate\": [0, 90, 0], \"translate\": [0, 7, 0]", false, {2, 4, 6}, {3, 9, -1}},
        {", \"mirror\": \"z\"", false, {1, 2, 3}, {1, 2, -3}}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        char text[256];
        snprintf(text, sizeof text, HEAD "\"meshes\": [{\"file\": \"m\"%s}]}", all[i].text);
        shape_scene *scene = read_good(text);
        shape_frame frame = shape_scene_mesh_frame(&scene->meshes[0], all[i].z_up);
        const double *f = all[i].from, *t = all[i].to;
        shape_dvec3 p = shape_frame_point(&frame, shape_dvec3_make(f[0], f[1], f[2]));
        if (fabs(p.x - t[0]) > 1e-12 || fabs(p.y - t[1]) > 1e-12 || fabs(p.z - t[2]) > 1e-12)
            fail_msg("\"%s\" puts the point at %g, %g, %g", all[i].text, p.x, p.y, p.z);
        shape_scene_destroy(scene);
    }
}

/* Writing, reading and writing again gives the same bytes, so nothing is lost on the way. */
static void written_scenes_read_back(void **state)
{
    (void)state;
    const char *const texts[] = {
        everything, CLOUDS "]}", HEAD "\"sun\": \"none\", \"sky\": \"none\"}",
        HEAD "\"sky\": \"clear\", \"camera\": {}}",
        HEAD "\"sun\": {\"direction\": [0.3, 0.2, -0.7]}, \"camera\": {\"eye\": [0.1, -0.0, 1e11]}}"};
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        shape_error error;
        shape_scene *scene = read_good(texts[i]);
        char *first, *second;
        size_t first_size, second_size;
        assert_int_equal(shape_scene_encode(scene, &first, &first_size, &error), SHAPE_OK);
        assert_int_equal(strlen(first), first_size);
        shape_scene *again = read_good(first);
        assert_int_equal(shape_scene_encode(again, &second, &second_size, &error), SHAPE_OK);
        assert_string_equal(first, second);
        free(first);
        free(second);
        shape_scene_destroy(scene);
        shape_scene_destroy(again);
    }
}

/* Every double survives; the shortest text is taken. */
static void numbers_survive(void **state)
{
    (void)state;
    static const double numbers[] = {
        0, -0.0, 1, 100, 0.1, 1.0 / 3, 3.141592653589793, 1e-300, 1e22, 123456789012345678.0};
    char text[SCENE_NUMBER_MAX];
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        scene_number_text(numbers[i], text);
        double back = strtod(text, NULL);
        assert_memory_equal(&back, &numbers[i], sizeof back);
    }
    scene_number_text(0.1, text);
    assert_string_equal(text, "0.1");
    scene_number_text(100, text);
    assert_string_equal(text, "100");
    static const char *const plain[] = {"0", "40", "-3", "0.5", "1e-07"}, *const not_plain[] = {
                                                                              "",
                                                                              "040",
                                                                              "3.80",
                                                                              "1e3",
                                                                              ".5",
                                                                              "+1",
                                                                              "-",
                                                                              "1,2",
                                                                              "-0",
                                                                              "nan",
                                                                              "18446744073709551615"};
    for (size_t i = 0; i < sizeof plain / sizeof *plain; i++)
        assert_true(scene_number_is_plain(plain[i]));
    for (size_t i = 0; i < sizeof not_plain / sizeof *not_plain; i++)
        assert_false(scene_number_is_plain(not_plain[i]));
}

/* The direction and the two angles are the same sun: to 1e-12, some roundings of atan2, sin and cos. */
static void sun_directions_become_angles(void **state)
{
    (void)state;
    static const double directions[][3] = {
        {1, 0, 0}, {0, 1, 0}, {0, -2, 0}, {0.3, 0.2, -0.7}, {-5, 0.001, 4}};
    for (size_t i = 0; i < sizeof directions / sizeof *directions; i++) {
        const double *d = directions[i];
        char text[256];
        snprintf(text, sizeof text, HEAD "\"sun\": {\"direction\": [%.17g, %.17g, %.17g]}}", d[0], d[1],
                 d[2]);
        shape_scene *scene = read_good(text);
        shape_dvec3 sun = shape_sun_direction(scene->sun[0], scene->sun[1]);
        double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        assert_true(fabs(sun.x - d[0] / length) < 1e-12 && fabs(sun.y - d[1] / length) < 1e-12 &&
                    fabs(sun.z - d[2] / length) < 1e-12);
        shape_scene_destroy(scene);
    }
}

static void mistakes_have_their_place(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } all[] = {
        {"", "s.json:1:"},
        {"{\"scene\": 1,\n \"clouds\": [}", "s.json:2:"},
        {"[1]", "not a scene"},
        {"{}", "not a scene"},
        {"{\"scene\": 2, \"clouds\": []}", "s.json: scene: expected 1"},
        {"{\"scene\": 1}", "no clouds"},
        {HEAD "\"scene\": 1}", "duplicate"},
        {HEAD "\"meshes\": {}}", "meshes: expected an array"},
        {HEAD "\"meshes\": [3]}", "meshes[0]: expected an object"},
        {HEAD "\"meshes\": [{\"file\": \"a.obj\"}, {}]}", "meshes[1]: names no file"},
        {HEAD "\"meshes\": [{\"file\": 1}]}", "meshes[0].file: expected a text"},
        {HEAD "\"meshes\": [{\"file\": \"\"}]}", "meshes[0].file: is empty"},
        {HEAD "\"meshes\": [{\"file\": \"a\", \"up\": \"x\"}]}", "meshes[0].up: expected \"y\" or \"z\""},
        {HEAD "\"meshes\": [{\"file\": \"a\", \"unit\": 0}]}", "meshes[0].unit: 0 is out of range"},
        {HEAD "\"meshes\": [{\"file\": \"a\", \"albedo\": 1.1}]}", "meshes[0].albedo: 1.1 is out of range"},
        {HEAD "\"meshes\": [{\"file\": \"a\", \"albedo\": [0, 2, 0]}]}", "meshes[0].albedo[1]: 2 is out of"},
        {HEAD "\"meshes\": [{\"file\": \"a\", \"scale\": 0}]}", "meshes[0].scale: 0 is out of range"},
        {HEAD "\"meshes\": [{\"file\": \"a\", \"keep-depth\": true}]}",
         "meshes[0]: there is no key \"keep-depth\""},
        {HEAD "\"lightning\": 1}", "the keys are scene, clouds, meshes, ground"},
        {HEAD "\"edits\": [{\"hidden\": true}]}", "edits[0]: names no cloud"},
        {HEAD "\"edits\": [{\"cloud\": \"a\", \"hid\\nden\": 1}]}", "\"hid?den\""},
        {HEAD "\"edits\": [{\"cloud\": \"a\"}, {\"cloud\": \"a\"}]}",
         "edits[1]: the cloud \"a\" is edited already"},
        {HEAD "\"edits\": [{\"cloud\": \"a\", \"scale\": [1, 1, 1]}]}", "edits[0].scale: expected a number"},
        {HEAD "\"edits\": [{\"cloud\": \"a\", \"hidden\": 1}]}", "edits[0].hidden: expected true or false"},
        {HEAD "\"ground\": {\"height\": 2e6}}", "ground.height: 2000000 is out of range"},
        {HEAD "\"sun\": {\"day\": {\"hour\": 25}}}", "sun.day.hour: 25 is out of range"},
        {HEAD "\"compare\": \"\"}", "compare: is empty"},
        {HEAD "\"note\": 3}", "note: expected a text"},
        {HEAD "\"camera\": {\"eye\": [0, 0]}}", "camera.eye: expected three numbers"},
        {HEAD "\"camera\": {\"eye\": [0, 0, \"1\"]}}", "camera.eye[2]: expected a number"},
        {HEAD "\"camera\": {\"eye\": [1, 2, 3], \"target\": [1, 2, 3]}}", "same point"},
        {HEAD "\"camera\": {\"fov\": 180}}", "camera.fov: 180 is out of range"},
        {HEAD "\"camera\": {\"size\": [0, 36]}}", "camera.size"},
        {HEAD "\"camera\": {\"size\": [64.5, 36]}}", "camera.size"},
        {HEAD "\"camera\": {\"up\": [0, 1, 0]}}", "camera: there is no key \"up\""},
        {HEAD "\"sun\": {\"azimuth\": 10}}", "go together"},
        {HEAD "\"sun\": {\"azimuth\": 10, \"height\": 1, \"direction\": [1, 0, 0]}}", "give one of them"},
        {HEAD "\"sun\": {\"direction\": [0, 0, 0]}}", "direction is [0, 0, 0]"},
        {HEAD "\"sun\": {\"irradiance\": -1}}", "sun.irradiance: -1 is out of range"},
        {HEAD "\"sun\": true}", "sun: expected an object"},
        {HEAD "\"lamp\": {\"intensity\": 3}}", "no position"},
        {HEAD "\"sky\": \"blue\"}", "sky: expected"},
        {HEAD "\"sky\": [1, 2, -3]}", "sky[2]"},
        {HEAD "\"exposure\": 1e400}", "s.json:1:"},
        {HEAD "\"exposure\": NaN}", "s.json:1:"},
        {HEAD "\"medium\": {\"a b\": 1}}", "no option's name"},
        {HEAD "\"medium\": {\"g\": null}}", "medium.g: expected a number"},
        {HEAD "\"medium\": {\"g\": false}}", "medium.g: is false"},
        {HEAD "\"medium\": {\"g\": [1, 2, 3, 4]}}", "two or three"},
        {CLOUDS "{}]}", "clouds[0]: names neither"},
        {CLOUDS "{\"file\": \"a\", \"generator\": \"b\"}]}", "names both"},
        {CLOUDS "{\"file\": \"a\", \"options\": {\"count\": 1}}]}", "belong to a generator"},
        {CLOUDS "{\"file\": \"\"}]}", "clouds[0].file: is empty"},
        {CLOUDS "{\"file\": \"a\\u0007b\"}]}", "control character"},
        {CLOUDS "{\"file\": \"a\\u0000b\"}]}", "s.json:1:"},
        {CLOUDS "{\"file\": \"a\", \"copies\": []}]}", "at least one place"},
        {CLOUDS "{\"file\": \"a\", \"copies\": [{}, {\"scale\": 0}]}]}",
         "clouds[0].copies[1].scale: 0 is out"},
        {CLOUDS "{\"file\": \"a\", \"mirror\": \"xw\"}]}", "clouds[0].mirror"},
        {CLOUDS "{\"file\": \"a\", \"keep-depth\": 1}]}", "true or false"},
        {CLOUDS "{\"file\": \"a\"}, {\"fiel\": \"b\"}]}", "clouds[1]: there is no key \"fiel\""}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        must_refuse(all[i].text, all[i].said);
}

static char *repeat(const char *before, const char *part, size_t count, const char *after)
{
    char *text = malloc(strlen(before) + count * strlen(part) + strlen(after) + 1), *to = text;
    assert_non_null(text);
    to += sprintf(to, "%s", before);
    for (size_t i = 0; i < count; i++)
        to += sprintf(to, "%s", part);
    sprintf(to, "%s", after);
    return text;
}

static void refuse_repeat(const char *before, const char *part, size_t count, const char *after,
                          const char *said)
{
    char *text = repeat(before, part, count, after);
    must_refuse(text, said);
    free(text);
}

static void limits_hold(void **state)
{
    (void)state;
    refuse_repeat("", "[", 100000, "", "in one another");
    refuse_repeat("", "{\"a\":", 9, "1}}}}}}}}}", "in one another");
    refuse_repeat(HEAD "\"note\": [", "0,", SHAPE_SCENE_VALUES_MAX, "0]}", "values");
    refuse_repeat("", " ", SHAPE_SCENE_SIZE_MAX + 1, "", "larger than the limit");
    refuse_repeat(CLOUDS "{\"file\": \"", "x", SHAPE_SCENE_TEXT_MAX + 1, "\"}]}", "longer than");
    refuse_repeat(CLOUDS "{\"file\": \"a\", \"name\": \"", "x", SHAPE_NAME_MAX + 1, "\"}]}", "longer than");
    refuse_repeat(HEAD "\"meshes\": [", "{\"file\": \"a\"},", SHAPE_SCENE_MESHES_MAX, "{\"file\": \"a\"}]}",
                  "meshes[1000]: more than 1000 meshes");
    refuse_repeat(CLOUDS "{\"file\": \"a\", \"copies\": [", "{},", SHAPE_SCENE_CLOUDS_MAX, "{}]}]}",
                  "clouds");
    /* Brackets and commas within texts count for nothing. */
    char *text = repeat(HEAD "\"note\": \"\\\"", "[[[,,,", 200000, "\"}");
    shape_scene_destroy(read_good(text));
    free(text);
}

/* A struct that a caller filled is checked like a file. */
static void bad_structs_are_not_written(void **state)
{
    (void)state;
    shape_error error;
    shape_scene_cloud *cloud;
    shape_scene *scene = shape_scene_create(&error);
    char *text = NULL;
    size_t size;
    assert_int_equal(shape_scene_add_cloud(scene, &cloud, &error), SHAPE_OK);
    assert_int_equal(shape_scene_encode(scene, &text, &size, &error), SHAPE_ERROR_FORMAT);
    assert_non_null(strstr(error.text, "clouds[0]"));
    assert_int_equal(shape_scene_set_text(&cloud->file, "bad\xff.neph", &error), SHAPE_OK);
    assert_int_equal(shape_scene_encode(scene, &text, &size, &error), SHAPE_ERROR_ARGUMENT);
    assert_int_equal(shape_scene_set_text(&cloud->file, "good \"name\" \xc3\xa4.neph", &error), SHAPE_OK);
    scene->fov_given = true;
    scene->fov = NAN;
    assert_int_not_equal(shape_scene_encode(scene, &text, &size, &error), SHAPE_OK);
    scene->fov = 50;
    assert_int_equal(shape_scene_encode(scene, &text, &size, &error), SHAPE_OK);
    shape_scene *again = read_good(text);
    assert_string_equal(again->clouds[0].file, cloud->file);
    free(text);
    shape_scene_destroy(again);
    shape_scene_destroy(scene);
}

/* --- files --- */

static char folder[512];

static int make_files(void **state)
{
    (void)state;
    const char *temporary = getenv("TMPDIR");
    int length =
        snprintf(folder, sizeof folder, "%s/test_scene.XXXXXX", temporary && *temporary ? temporary : "/tmp");
    if (length < 0 || (size_t)length >= sizeof folder || !mkdtemp(folder) || chdir(folder) ||
        !getcwd(folder, sizeof folder) || mkdir("in", 0700) || mkdir("in/deep", 0700) ||
        mkfifo("in/pipe", 0600))
        return -1;
    static const char *const names[] = {"out.neph", "in/a.neph", "in/deep/b.neph"};
    for (int i = 0; i < 3; i++) {
        FILE *file = fopen(names[i], "w");
        if (!file || fclose(file))
            return -1;
    }
    return symlink("../out.neph", "in/link.neph") || symlink("deep/b.neph", "in/fine.neph");
}

static int remove_files(void **state)
{
    (void)state;
    static const char *const names[] = {"in/link.neph", "in/fine.neph", "in/deep/b.neph",
                                        "in/a.neph",    "in/pipe",      "out.neph"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        unlink(names[i]);
    rmdir("in/deep");
    rmdir("in");
    return chdir("/") || rmdir(folder);
}

static void files_stay_in_the_folder(void **state)
{
    (void)state;
    static const struct {
        const char *file;
        bool inside, anywhere;
    } all[] = {{"a.neph", true, true},
               {"deep/b.neph", true, true},
               {"./a.neph", true, true},
               {"fine.neph", true, true},
               {"link.neph", false, true},
               {"../out.neph", false, true},
               {"deep/../a.neph", false, true},
               {"/etc/hostname", false, true},
               {"deep", false, false},
               {"pipe", false, false},
               {"none.neph", false, false},
               {"-", false, false},
               {"", false, false}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        for (int outside = 0; outside < 2; outside++) {
            if (*all[i].file == '/' && outside && access(all[i].file, R_OK))
                continue;
            shape_error error = {SHAPE_OK, ""};
            char *path = NULL;
            shape_status status = shape_scene_find_file("in/s.json", all[i].file, outside, &path, &error);
            bool expected = outside ? all[i].anywhere : all[i].inside;
            if (!status != expected)
                fail_msg("\"%s\"%s: %s", all[i].file, outside ? " allowed outside" : "", error.text);
            if (!status)
                assert_int_equal(access(path, R_OK), 0);
            free(path);
        }
}

static void names_are_relative_to_the_scene(void **state)
{
    (void)state;
    static const struct {
        const char *scene, *path, *file;
        bool outside;
    } all[] = {{"s.json", "in/a.neph", "in/a.neph", false},
               {"in/s.json", "in/a.neph", "a.neph", false},
               {"in/s.json", "out.neph", "../out.neph", true},
               {"in/deep/s.json", "in/a.neph", "../a.neph", true},
               {"in/deep/s.json", "out.neph", "../../out.neph", true},
               {"in/s.json", "in/link.neph", "link.neph", false},
               {"./in/deep/../s.json", "./in/deep/b.neph", "deep/b.neph", false}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        shape_error error;
        char *file, *found;
        bool outside;
        assert_int_equal(shape_scene_relative(all[i].scene, all[i].path, &file, &outside, &error), SHAPE_OK);
        assert_string_equal(file, all[i].file);
        assert_int_equal(outside, all[i].outside);
        assert_int_equal(shape_scene_find_file(all[i].scene, file, true, &found, &error), SHAPE_OK);
        free(file);
        free(found);
    }
}

/* A picture that neph-view's window has written is a scene; cut anywhere, or without the text, it is a mistake. Built by
 * hand from the formats' descriptions. */
static void pictures_hold_scenes(void **state)
{
    (void)state;
    static const char scene_text[] = "{\"scene\": 1, \"clouds\": [], \"exposure\": 2}";
    unsigned char file[3][256];
    size_t sizes[3], text = sizeof scene_text - 1;
    for (int kind = 0; kind < 2; kind++) { /* PNG: a text chunk of bytes, then one of UTF-8 */
        unsigned char *at = file[kind], *length;
        const char head[] = "\x89PNG\r\n\x1a\n\0\0\0\2IDAT12ABCD";
        memcpy(at, head, sizeof head - 1);
        at += sizeof head - 1;
        length = at;
        memcpy(at + 4, kind ? "iTXt" : "tEXt", 4);
        at += 8;
        memcpy(at, SHAPE_SCENE_PICTURE_KEY, sizeof SHAPE_SCENE_PICTURE_KEY);
        at += sizeof SHAPE_SCENE_PICTURE_KEY;
        memset(at, 0, 4);
        at += kind ? 4 : 0; /* not compressed, by no method, no language, no other key */
        memcpy(at, scene_text, text);
        at += text;
        size_t size = (size_t)(at - length) - 8;
        const unsigned char big_endian[4] = {0, 0, (unsigned char)(size >> 8), (unsigned char)size};
        memcpy(length, big_endian, 4);
        memset(at, 0, 4); /* the sum is the picture's reader's to check */
        sizes[kind] = (size_t)(at + 4 - file[kind]);
    }
    unsigned char *at = file[2];
    const char head[] = "\x76\x2f\x31\x01\2\0\0\0name\0int\0\4\0\0\0abcd" SHAPE_SCENE_PICTURE_KEY "\0string";
    memcpy(at, head, sizeof head);
    at += sizeof head;
    const unsigned char little_endian[4] = {(unsigned char)text, 0, 0, 0};
    memcpy(at, little_endian, 4);
    memcpy(at + 4, scene_text, text);
    sizes[2] = sizeof head + 4 + text;
    for (int kind = 0; kind < 3; kind++) {
        shape_error error = {SHAPE_OK, ""};
        shape_scene *scene = NULL;
        assert_true(shape_scene_is(file[kind], sizes[kind]));
        if (shape_scene_decode(file[kind], sizes[kind], "p", &scene, &error))
            fail_msg("%d: %s", kind, error.text);
        assert_true(scene->exposure == 2);
        shape_scene_destroy(scene);
        for (size_t cut = 0; cut + 5 < sizes[kind]; cut++) { /* on the heap, so that a byte too far shows */
            unsigned char *part = malloc(cut + 1);
            memcpy(part, file[kind], cut);
            scene = NULL;
            assert_int_not_equal(shape_scene_decode(part, cut, "p", &scene, &error), SHAPE_OK);
            free(part);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(all_keys_are_read),
                                       cmocka_unit_test(pictures_hold_scenes),
                                       cmocka_unit_test(meshes_stand_where_they_are_put),
                                       cmocka_unit_test(written_scenes_read_back),
                                       cmocka_unit_test(numbers_survive),
                                       cmocka_unit_test(sun_directions_become_angles),
                                       cmocka_unit_test(mistakes_have_their_place),
                                       cmocka_unit_test(limits_hold),
                                       cmocka_unit_test(bad_structs_are_not_written),
                                       cmocka_unit_test(files_stay_in_the_folder),
                                       cmocka_unit_test(names_are_relative_to_the_scene)};
    return cmocka_run_group_tests(tests, make_files, remove_files);
}
