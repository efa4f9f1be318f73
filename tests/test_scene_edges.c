/* Scenes at their edges: values that are just not what a key takes, every way a member can be left out and written again, and
 * the paths of named files when memory runs out. */
#include "failing_memory.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <sys/stat.h>
#include <unistd.h>

#include "shape/scene.h"

#define CLOUD "{\"scene\": 1, \"clouds\": [{\"file\": \"a\", "
#define HEAD "{\"scene\": 1, \"clouds\": [], "

static void refused(const char *text, const char *said)
{
    shape_error error = {.text = ""};
    shape_scene *scene = NULL;
    if (!shape_scene_decode(text, strlen(text), "s.json", &scene, &error))
        fail_msg("taken: %s", text);
    if (!strstr(error.text, said))
        fail_msg("\"%s\" does not say \"%s\"", error.text, said);
    assert_null(scene);
}

static shape_scene *read_good(const char *text)
{
    shape_error error;
    shape_scene *scene = NULL;
    if (shape_scene_decode(text, strlen(text), "s.json", &scene, &error))
        fail_msg("%s, in %s", error.text, text);
    return scene;
}

static void values_that_do_not_fit(void **state)
{
    (void)state;
    static const struct {
        const char *text, *said;
    } all[] = {{CLOUD "\"medium\": 3}]}", "medium: expected an object"},
               {CLOUD "\"medium\": {\"g\": [1]}}]}", "medium.g: expected two or three numbers"},
               {CLOUD "\"medium\": {\"g\": [1, \"a\"]}}]}", "medium.g: expected two or three numbers"},
               {CLOUD "\"medium\": {\"g\": {}}}]}", "medium.g: expected a number"},
               {CLOUD "\"medium\": {\"\": 1}}]}", "is no option's name"},
               {CLOUD "\"medium\": {\"g\": \"\"}}]}", "medium.g: is empty"},
               {CLOUD "\"medium\": {\"note\": 3}}]}", "medium.note: expected a text"},
               {CLOUD "\"name\": 3}]}", "name: expected a text"},
               {CLOUD "\"note\": 3}]}", "note: expected a text"},
               {CLOUD "\"copies\": 3}]}", "at least one place"},
               {CLOUD "\"copies\": [3]}]}", "copies[0]: expected an object"},
               {CLOUD "\"input\": \"b\"}]}", "belong to a generator"},
               {CLOUD "\"mirror\": 3}]}", "mirror: expected x, y, z"},
               {CLOUD "\"mirror\": \"\"}]}", "mirror: expected x, y, z"},
               {CLOUD "\"scale\": \"2\"}]}", "scale: expected a number, or three"},
               {CLOUD "\"translate\": {}}]}", "translate: expected three numbers"},
               {CLOUD "\"name\": \"a\\u007f\"}]}", "control character"},
               {CLOUD "\"name\": \"a\\u0085\"}]}", "control character"},
               {HEAD "\"sky\": true}", "sky: expected \"none\""},
               {HEAD "\"sky\": {}}", "sky: expected \"none\""},
               {HEAD "\"sun\": \"one\"}", "sun: expected an object"},
               {HEAD "\"sun\": 3}", "sun: expected an object"},
               {HEAD "\"lamp\": 3}", "lamp: expected an object"},
               {HEAD "\"lamp\": {\"position\": [0, 0, 0], \"intensity\": -1}}", "lamp.intensity: -1 is out"},
               {HEAD "\"air\": {\"height\": 3}}", "has no visibility"},
               {HEAD "\"air\": {\"visibility\": 0}}", "air.visibility: 0 is out of range"},
               {HEAD "\"camera\": {\"size\": 3}}", "camera.size: expected two numbers"},
               {HEAD "\"camera\": {\"size\": [1, 2, 3]}}", "camera.size: expected two numbers"},
               {HEAD "\"camera\": {\"size\": [16385, 1]}}", "whole numbers from 1 to 16384"},
               {HEAD "\"camera\": {\"size\": [1, \"2\"]}}", "whole numbers from 1 to 16384"},
               {HEAD "\"camera\": {\"fov\": \"3\"}}", "camera.fov: expected a number"},
               {HEAD "\"clouds\": 3}", "duplicate"},
               {"{\"scene\": 1, \"clouds\": 3}", "clouds: expected an array"},
               {"{\"scene\": \"1\", \"clouds\": []}", "scene: expected 1"},
               {"{\"scene\": 1.0, \"clouds\": []}", "scene: expected 1"}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++)
        refused(all[i].text, all[i].said);
    /* The nearest that do. */
    shape_scene_destroy(
        read_good(CLOUD "\"name\": \"a\\u00a0\\u0020\", \"medium\": {\"note\": \"x\", \"g\": [1, 2.5]}}]}"));
    shape_scene *scene = read_good(CLOUD "\"keep-depth\": false, \"mirror\": \"yy\"}]}");
    assert_false(scene->clouds[0].place.keep_depth);
    assert_true(scene->clouds[0].place.mirror[1] && !scene->clouds[0].place.mirror[0]);
    shape_scene_destroy(scene);
    assert_false(shape_scene_is(" \t\r\n", 4));
    assert_false(shape_scene_is("\0{", 2));
    assert_true(shape_scene_is(" \t\r\n{", 5));
}

/* Written, read, and written again: the same text, which holds what it should. */
static void comes_back(const char *text, const char *part, bool holds)
{
    shape_error error;
    char *written[2];
    size_t sizes[2];
    shape_scene *scene = read_good(text);
    for (int i = 0; i < 2; i++) {
        if (shape_scene_encode(scene, &written[i], &sizes[i], &error))
            fail_msg("%s, in %s", error.text, text);
        shape_scene_destroy(scene);
        scene = read_good(written[i]);
    }
    shape_scene_destroy(scene);
    assert_int_equal(sizes[0], sizes[1]);
    assert_memory_equal(written[0], written[1], sizes[0]);
    if (!strstr(written[0], part) != !holds)
        fail_msg("%s \"%s\" in:\n%s", holds ? "no" : "a", part, written[0]);

    free(written[0]);
    free(written[1]);
}

static void each_way_is_written_and_read(void **state)
{
    (void)state;
    char text[512], part[64];
    for (int axes = 0; axes < 8; axes++) {
        snprintf(part, sizeof part, "\"mirror\": \"%s%s%s\"", axes & 1 ? "x" : "", axes & 2 ? "y" : "",
                 axes & 4 ? "z" : "");
        snprintf(text, sizeof text,
                 CLOUD "%s%s\"scale\": [1, 1, %d], \"rotate\": [0, %d, 1], \"translate\": [0, 0, 4]}]}",
                 axes ? part : "", axes ? ", " : "", axes, axes);
        if (axes)
            comes_back(text, part, true);
    }
    comes_back(CLOUD "\"scale\": [2, 2, 2]}]}", "\"scale\": 2", true);
    comes_back(CLOUD "\"scale\": [2, 2, 3]}]}", "\"scale\": [2, 2, 3]", true);
    comes_back(CLOUD "\"scale\": [1, 1, 1]}]}", "scale", false);
    comes_back(CLOUD "\"scale\": [1, 3, 1]}]}", "\"scale\": [1, 3, 1]", true);
    comes_back(CLOUD "\"medium\": {\"a\": \"1,2,3,4\"}}]}", "\"a\": \"1,2,3,4\"", true);
    comes_back(CLOUD "\"medium\": {\"a\": \"1,2,3\"}}]}", "\"a\": [1, 2, 3]", true);
    comes_back(CLOUD "\"medium\": {\"a\": \"1,2,\"}}]}", "\"a\": \"1,2,\"", true);
    comes_back(CLOUD "\"medium\": {\"a\": \"1,02\"}}]}", "\"a\": \"1,02\"", true);
    comes_back(CLOUD "\"medium\": {\"a\": \"5\", \"b\": true, \"c\": 7}}]}", "\"a\": 5", true);
    comes_back(CLOUD "\"medium\": {\"a\": \"1,0000000000000000000000000000000000000000000000001\"}}]}", "[1",
               false);
    static const char *const cameras[] = {"\"eye\": [1, 2, 3]", "\"target\": [1, 2, 3]", "\"fov\": 30",
                                          "\"size\": [4, 5]"},
                             *const suns[] = {"\"irradiance\": [1, 2, 3]", "\"angle\": 3", "\"hour\": 3",
                                              "\"azimuth\": 3"};
    for (int i = 0; i < 4; i++) {
        snprintf(text, sizeof text, HEAD "\"camera\": {%s}}", cameras[i]);
        comes_back(text, cameras[i], true);
        snprintf(text, sizeof text,
                 i == 2   ? HEAD "\"sun\": {\"day\": {%s, \"declination\": 1}}}"
                 : i == 3 ? HEAD "\"sun\": {%s, \"height\": 4}}"
                          : HEAD "\"sun\": {%s}}",
                 suns[i]);
        comes_back(text, suns[i], true);
    }
    comes_back(HEAD "\"camera\": {}}", "camera", false);
    comes_back(HEAD "\"sun\": {}}", "sun", false);
    comes_back(HEAD "\"sun\": \"none\"}", "\"sun\": \"none\"", true);
    comes_back(HEAD "\"sky\": \"none\"}", "\"sky\": \"none\"", true);
    comes_back(HEAD "\"sky\": \"clear\"}", "\"sky\": \"clear\"", true);
    comes_back(HEAD "\"sky\": 0.5}", "\"sky\": [0.5, 0.5, 0.5]", true);
    comes_back(HEAD "\"air\": {\"visibility\": 5}}", "height", false);
    comes_back(HEAD "\"air\": {\"visibility\": 5, \"height\": 6}}", "\"height\": 6", true);
    comes_back(HEAD "\"edits\": [{\"cloud\": \"a\", \"hidden\": false}]}", "hidden", false);
}

/* --- paths --- */

static char folder[64], scene_path[128], file_path[128];

static int make_folder(void **state)
{
    (void)state;
    strcpy(folder, "/tmp/scene_edges.XXXXXX");
    if (!mkdtemp(folder))
        return -1;
    snprintf(scene_path, sizeof scene_path, "%s/s.json", folder);
    snprintf(file_path, sizeof file_path, "%s/a.neph", folder);
    FILE *file = fopen(file_path, "wb");
    return file ? fclose(file) : -1;
}

static int drop_folder(void **state)
{
    (void)state;
    unlink(file_path);
    return rmdir(folder);
}

static shape_status find_and_name(shape_error *error)
{
    char *path, *name;
    bool outside;
    shape_status status = shape_scene_find_file(scene_path, "a.neph", false, &path, error);
    if (status)
        return status;
    assert_string_equal(path, file_path);
    status = shape_scene_relative(scene_path, path, &name, &outside, error);
    if (!status) {
        assert_string_equal(name, "a.neph");
        assert_false(outside);
        free(name);
    }
    free(path);
    return status;
}

static void names_and_ways(void **state)
{
    (void)state;
    shape_error error = {.text = ""};
    char *path, *name, from_root[140];
    bool outside;
    static const char *const none[] = {"", "-"};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(shape_scene_find_file(scene_path, none[i], true, &path, &error),
                         SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, "is no file's name"));
    }
    static const char *const outward[] = {"..", "../a", "b/..", "b/../a", "/a"};
    for (size_t i = 0; i < sizeof outward / sizeof *outward; i++) {
        assert_int_equal(shape_scene_find_file(scene_path, outward[i], false, &path, &error),
                         SHAPE_ERROR_ARGUMENT);
        assert_non_null(strstr(error.text, "leaves the scene's folder"));
    }
    /* Dots within a name, or one alone, climb nowhere. */
    static const char *const inward[] = {"..a", "a..", ".", "./a.neph", ".a", "a/.b"};
    for (size_t i = 0; i < sizeof inward / sizeof *inward; i++) {
        shape_status status = shape_scene_find_file(scene_path, inward[i], false, &path, &error);
        assert_int_equal(status, i == 3 ? SHAPE_OK : SHAPE_ERROR_IO);
        if (!status)
            free(path);
    }
    /* A scene in the root finds what lies below, without a second stroke. */
    snprintf(from_root, sizeof from_root, "%s", file_path + 1);
    assert_int_equal(shape_scene_find_file("/s.json", from_root, false, &path, &error), SHAPE_OK);
    assert_string_equal(path, file_path);
    free(path);
    assert_int_equal(shape_scene_relative("/s.json", file_path, &name, &outside, &error), SHAPE_OK);
    assert_string_equal(name, from_root);
    assert_false(outside);
    free(name);
    assert_int_equal(shape_scene_relative(scene_path, "/a.neph", &name, &outside, &error), SHAPE_OK);
    assert_string_equal(name, "../../a.neph");
    assert_true(outside);
    free(name);
    assert_int_equal(shape_scene_relative("/none/at/all.json", file_path, &name, &outside, &error),
                     SHAPE_ERROR_IO);
    assert_int_equal(shape_scene_relative(scene_path, "/none/at/all", &name, &outside, &error),
                     SHAPE_ERROR_IO);
    assert_non_null(strstr(error.text, "/none/at"));
}

static void memory_runs_out(void **state)
{
    (void)state;
    for (long n = 0;; n++) {
        shape_error error = {.text = ""};
        allocations_left = n;
        shape_status status = find_and_name(&error);
        bool used_up = allocations_left < 0;
        allocations_left = -1;
        if (!used_up) {
            assert_int_equal(status, SHAPE_OK);
            assert_true(n >= 6); /* two folders' names, two paths', a way and a name */
            return;
        }
        assert_int_equal(status, SHAPE_ERROR_MEMORY);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(values_that_do_not_fit),
                                       cmocka_unit_test(each_way_is_written_and_read),
                                       cmocka_unit_test(names_and_ways), cmocka_unit_test(memory_runs_out)};
    return cmocka_run_group_tests(tests, make_folder, drop_folder);
}
