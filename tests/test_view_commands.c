/* The generators of the panel: the cloud that the window shows is, byte for byte, what the copied commands make; whatever
 * options are set, of each of them. Runs the programs. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "../viewer/entry.h"
#include "../viewer/setting.h"
#include "../viewer/state_scene.h"
#include "shape/file.h"
#include "shape/neph.h"

typedef struct option {
    const char *name;
    double number[3];
} option;

/* One of each kind that the generator has: numbers, flags, words, ranges, vectors. */
static const struct {
    const char *program, *input;
    option options[5];
} all[] = {
    {"neph-gauss",
     "",
     {{"count", {9}},
      {"sigma", {5, 1.25, 0.1}},
      {"radius-law", {0}},
      {"no-hollow", {1}},
      {"max-radius", {2.3}}}},
    {"neph-meta", "", {{"count", {5}}, {"sigma", {1, 2, 0.3}}, {"max-radius", {1.7}}}},
    {"neph-layer",
     "",
     {{"noise", {1}},
      {"ramp", {0.3, 0.4}},
      {"extent", {9, 4, 7}},
      {"fade-top", {0.35}},
      {"coverage", {0.62}}}},
    {"neph-lsys",
     "heap.lsys",
     {{"iterations", {4}}, {"angle", {20, 40.5}}, {"radius", {0.7, 0.7}}, {"shrink", {0.8, 0.9}}}},
    {"neph-mesh", "wedge.obj", {{"faces", {4}}, {"scale", {1.3}}, {"no-rotate", {1}}, {"up", {1}}}},
};

static void write_text(const char *path, const char *text)
{
    shape_error error;
    assert_int_equal(shape_file_write(path, text, strlen(text), &error), SHAPE_OK);
}

static void set_options(view_generator *g, const option *options)
{
    for (int i = 0; i < 5 && options[i].name; i++) {
        int row = view_setting_find(g, options[i].name);
        assert_true(row >= 0);
        g->settings[row].given = true;
        memcpy(g->settings[row].number, options[i].number, sizeof options[i].number);
    }
}

/* The clouds' bytes, but for who made them: a grammar is derived by the window itself. */
static void encode(shape_set *set, const shape_set *made_by, unsigned char **bytes, size_t *size)
{
    shape_error error;
    memcpy(set->clouds[0].made_by, made_by->clouds[0].made_by, sizeof set->clouds[0].made_by);
    assert_int_equal(shape_neph_encode(set, bytes, size, &error), SHAPE_OK);
}

static void check_commands(const char *program, const char *input, const option *options)
{
    shape_error error = {SHAPE_OK, ""};
    view_contents contents;
    static char mistakes[4096], command[8192];
    view_generator g = view_generator_named(program, 7);
    assert_true(g.which >= 0);
    set_options(&g, options);
    if (view_source_read(input, &g, NULL, NULL, false, &contents, mistakes, sizeof mistakes, &error))
        fail_msg("%s: %s", program, mistakes);
    view_state *state = malloc(sizeof *state), *base = malloc(sizeof *base);
    view_state_reset(state);
    state->eye[2] = 9;
    view_state_take_set(state, contents.set, &contents.used);
    memcpy(base, state, sizeof *state);
    /* A medium that the panel has changed is the generator's, too. */
    state->clouds[0].medium.extinction = contents.set->clouds[0].medium.extinction = 3.25f;
    const view_command parts = {.path = input, .opening = "", .things = "", .size = {16, 9}, .seed = 7};
    view_command_write(state, base, &parts, command, sizeof command);
    *strchr(command, '\n') = 0;
    strcat(command, " 2>said");
    if (system(command))
        fail_msg("%s fails", command);
    shape_set *written;
    unsigned char *file, *bytes[2];
    size_t size, sizes[2];
    assert_int_equal(shape_file_read("cloud.neph", 1 << 28, &file, &size, &error), SHAPE_OK);
    assert_int_equal(shape_neph_decode(file, size, &written, &error), SHAPE_OK);
    free(file);
    assert_true(shape_primitives_count(shape_set_list(written, 0)) > 0);
    encode(written, written, &bytes[0], &sizes[0]);
    encode(contents.set, written, &bytes[1], &sizes[1]);
    if (sizes[0] != sizes[1] || memcmp(bytes[0], bytes[1], sizes[0]))
        fail_msg("%s makes another cloud than the window shows", command);
    free(bytes[0]);
    free(bytes[1]);
    shape_set_destroy(written);
    view_contents_free(&contents);
    free(base);
    free(state);
}

static void commands_make_what_is_seen(void **state)
{
    (void)state;
    const option none[5] = {{0}};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        check_commands(all[i].program, all[i].input, none);
        check_commands(all[i].program, all[i].input, all[i].options);
    }
}

/* Each option that stands as it is by itself may be said, too, and changes nothing: so what the panel begins with is the
 * program's own default. What has none is left out: the noise's size, a preset, and what goes with another option. */
static void defaults_are_the_programs(void **state)
{
    (void)state;
    static const char *const without[] = {"preset", "frequency", "altitudes", "planet-radius", "fill", "fit",
                                          "field",  "area",      "keep",      "size",          "up"};
    for (size_t i = 0; i < 3; i++) { /* the other two have a file's own */
        shape_error error;
        static char mistakes[4096];
        view_contents plain, said;
        view_setting_row row;
        view_generator g = view_generator_named(all[i].program, 3);
        assert_int_equal(
            view_source_read("", &g, NULL, NULL, false, &plain, mistakes, sizeof mistakes, &error), SHAPE_OK);
        for (int k = 0; view_setting_get_row(&g, k, &row); k++) {
            bool skip = row.kind == VIEW_SETTING_FLAG;
            for (size_t n = 0; n < sizeof without / sizeof *without; n++)
                skip = skip || !strcmp(row.name, without[n]);
            if (skip)
                continue;
            g.settings[k].given = true;
            if (view_source_read("", &g, NULL, NULL, false, &said, mistakes, sizeof mistakes, &error))
                fail_msg("%s --%s: %s", all[i].program, row.name, mistakes);
            g.settings[k].given = false;
            unsigned char *bytes[2];
            size_t sizes[2];
            encode(plain.set, plain.set, &bytes[0], &sizes[0]);
            encode(said.set, plain.set, &bytes[1], &sizes[1]);
            if (sizes[0] != sizes[1] || memcmp(bytes[0], bytes[1], sizes[0]))
                fail_msg("%s: the panel begins with another --%s than the program", all[i].program, row.name);
            free(bytes[0]);
            free(bytes[1]);
            view_contents_free(&said);
        }
        view_contents_free(&plain);
    }
}

static view_contents read_scene(const char *path, const view_generator *generator)
{
    shape_error error;
    view_contents contents;
    static char mistakes[4096];
    if (view_source_read(path, generator, NULL, NULL, false, &contents, mistakes, sizeof mistakes, &error))
        fail_msg("%s: %s", path, mistakes);
    return contents;
}

static void check_same_clouds(shape_set *a, shape_set *b, bool wanted)
{
    unsigned char *bytes[2];
    size_t sizes[2];
    encode(a, a, &bytes[0], &sizes[0]);
    encode(b, a, &bytes[1], &sizes[1]);
    bool same = sizes[0] == sizes[1] && !memcmp(bytes[0], bytes[1], sizes[0]);
    assert_int_equal(same, wanted);
    free(bytes[0]);
    free(bytes[1]);
}

static void set_one(view_generator *g, const char *name, double value)
{
    view_setting *setting = &g->settings[view_setting_find(g, name)];
    setting->given = true;
    setting->number[0] = setting->number[1] = value;
}

/* A scene's generator is in the panel as its file has it. What is changed there makes the cloud that the file would make if it
 * said so, in a folder of its own too; options that the panel has no row for stay; and a file that says something else is
 * followed. */
static void a_scenes_generator_can_be_changed(void **state)
{
    (void)state;
    static const char form[] =
        "{\"scene\": 1, \"clouds\": [{\"generator\": \"%s\"%s, \"options\": {%s}, \"name\": \"it\"}]}";
    static const struct {
        const char *program, *input, *options, *changed, *name, *given, *left;
        double value, left_is;
    } both[] = {
        {"neph-gauss", "",
         "\"count\": 9, \"sigma\": [5, 1.25, 0.1], \"no-hollow\": true, \"radius-law\": \"inverse\", "
         "\"extinction\": "
         "1.5, \"seed\": 3",
         "\"count\": 14, \"sigma\": [5, 1.25, 0.1], \"no-hollow\": true, \"radius-law\": \"inverse\", "
         "\"extinction\": 1.5, \"seed\": 3",
         "count", "radius-law", "max-radius", 14, 2.9},
        {"neph-lsys", ", \"input\": \"heap.lsys\"", "\"angle\": \"20..40\"",
         "\"angle\": \"20..40\", \"iterations\": 4", "iterations", "angle", "iterations", 4, 3}};
    for (size_t i = 0; i < sizeof both / sizeof *both; i++) {
        char text[1024];
        shape_error error;
        view_generator none = view_generator_none(1);
        snprintf(text, sizeof text, form, both[i].program, both[i].input, both[i].options);
        write_text("deep/scene.json", text);
        view_contents plain = read_scene("deep/scene.json", &none);
        view_generator g = plain.used;
        assert_string_equal(view_generator_program(&g), both[i].program);
        assert_int_equal(g.entry, 1);
        assert_true(g.settings[view_setting_find(&g, both[i].given)].given);
        assert_false(g.settings[view_setting_find(&g, both[i].left)].given);
        assert_true(g.settings[view_setting_find(&g, both[i].left)].number[0] == both[i].left_is);
        view_contents again = read_scene("deep/scene.json", &g);
        check_same_clouds(plain.set, again.set, true);
        set_one(&g, both[i].name, both[i].value);
        view_contents changed = read_scene("deep/scene.json", &g);
        assert_true(view_generator_same(&changed.used, &plain.used)); /* what the file says */
        check_same_clouds(plain.set, changed.set, false);
        /* Saved, it is the scene that says so. */
        assert_true(view_entry_stands(plain.scene, &g));
        assert_int_equal(view_entry_apply(plain.scene, &g, &error), SHAPE_OK);
        char *saved;
        size_t size;
        assert_int_equal(shape_scene_encode(plain.scene, &saved, &size, &error), SHAPE_OK);
        write_text("deep/saved.json", saved);
        free(saved);
        view_contents kept = read_scene("deep/saved.json", &none);
        check_same_clouds(kept.set, changed.set, true);
        /* Written by hand; and what was asked of the older file is not asked of this one. */
        snprintf(text, sizeof text, form, both[i].program, both[i].input, both[i].changed);
        write_text("deep/scene.json", text);
        set_one(&g, both[i].name, 2);
        view_contents file = read_scene("deep/scene.json", &g);
        check_same_clouds(file.set, changed.set, true);
        view_contents *all_read[] = {&plain, &again, &changed, &kept, &file};
        for (int k = 0; k < 5; k++)
            view_contents_free(all_read[k]);
    }
}

static int enter(void **state)
{
    (void)state;
    static char path[8192];
    char folder[] = "/tmp/view_commandsXXXXXX";
    snprintf(path, sizeof path, "%s:%s", PROGRAMS, getenv("PATH"));
    if (setenv("PATH", path, 1) || !mkdtemp(folder) || chdir(folder))
        return -1;
    if (mkdir("deep", 0700))
        return -1;
    write_text("deep/heap.lsys", "axiom X\niterations 3\nX -> X [ +(30) X ] [ -(25) X ]\n");
    write_text("heap.lsys", "axiom X\niterations 3\nX -> X [ +(30) X ] [ -(25) X ]\n");
    write_text("wedge.obj", "v 0 0 0\nv 2 0 0\nv 0 0 1\nv 1 3 0.5\nf 1 2 4\nf 2 3 4\nf 3 1 4\nf 1 3 2\n");
    return 0;
}

static int leave(void **state)
{
    (void)state;
    char folder[4096];
    static const char *const files[] = {"heap.lsys",      "wedge.obj",       "cloud.neph",      "said",
                                        "deep/heap.lsys", "deep/scene.json", "deep/saved.json", "deep"};
    for (size_t i = 0; i < sizeof files / sizeof *files; i++)
        remove(files[i]);
    return !getcwd(folder, sizeof folder) || rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(commands_make_what_is_seen),
        cmocka_unit_test(defaults_are_the_programs),
        cmocka_unit_test(a_scenes_generator_can_be_changed),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
