/* The clouds of a scene: read or generated, described, placed. */
#include "cli_scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_private.h"
#include "shape/combine.h"

/* Work on one scene. */
typedef struct maker {
    const char *path, *shown;
    shape_set *set;
    size_t primitives; /* in it */
    const shape_scene *scene;
} maker;

char *cli_scene_file(const char *scene_path, const char *file)
{
    shape_error error;
    char *path;
    cli_check(shape_scene_find_file(scene_path, file, cli_outside_allowed(), &path, &error), &error);
    return path;
}

static size_t count_primitives(const shape_set *set)
{
    size_t count = 0;
    for (size_t i = 0; i < set->list_count; i++)
        count += shape_primitives_count(&set->lists[i]);
    return count;
}

static const cli_generator *find_generator(const char *name)
{
    char all[160] = "";
    for (const cli_generator *const *g = cli_generators; *g; g++) {
        if (!strcmp((*g)->name, name))
            return *g;
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s%s", used ? ", " : "", (*g)->name);
    }
    cli_fail("there is no generator \"%.40s\" (there are %s)", name, all);
    return NULL;
}

/* What an entry names, before it is placed. */
static shape_set *make_source(const maker *m, const shape_scene_cloud *cloud, const char *place)
{
    cli_set_place("%s: ", place);
    if (cloud->file) {
        char *path = cli_scene_file(m->path, cloud->file);
        shape_set *set = cli_read_set(path);
        free(path);
        return set;
    }
    const cli_generator *generator = find_generator(cloud->generator);
    if (!generator->input && cloud->input)
        cli_fail("%s takes no input (leave \"input\" out)", generator->name);
    if (generator->input && !cloud->input)
        cli_fail("%s needs a file (write \"input\": \"%s\")", generator->name, generator->input);
    char *path = cloud->input ? cli_scene_file(m->path, cloud->input) : NULL;
    cli_generator_set_limit(SHAPE_SCENE_PRIMITIVES_MAX - m->primitives);
    shape_set *set = cli_generator_run(generator, path, &cloud->options, place);
    cli_generator_set_limit(SIZE_MAX);
    free(path);
    return set;
}

/* Name and medium. The program's own medium options are put back afterwards. */
static void describe(const maker *m, const shape_scene_cloud *cloud, shape_set *set, const char *place)
{
    cli_medium mine = cli_medium_values;
    const shape_scene_options *all[] = {&m->scene->medium, &cloud->medium};
    char places[2][512];
    snprintf(places[0], sizeof places[0], "%.400s: medium", m->shown);
    snprintf(places[1], sizeof places[1], "%.500s.medium", place);
    for (int k = 0; k < 2; k++) {
        if (!all[k]->count)
            continue;
        cli_medium_set(all[k], places[k]);
        for (size_t i = 0; i < set->cloud_count; i++)
            cli_medium_apply(&set->clouds[i]);
    }
    cli_medium_values = mine;
    for (size_t i = 0; i < set->cloud_count && cloud->name; i++)
        snprintf(set->clouds[i].name, sizeof set->clouds[i].name, "%s", cloud->name);
}

static bool scales_equally(const shape_transform *t)
{
    return t->scale[0] == t->scale[1] && t->scale[1] == t->scale[2];
}

/* How many primitives an entry will hold once it is placed: unequal scaling takes a list of its own for each copy. */
static void check_room(const maker *m, const shape_scene_cloud *cloud, const shape_set *source)
{
    size_t lists = !scales_equally(&cloud->place) && cloud->copy_count ? cloud->copy_count : 1;
    for (size_t i = 0; i < cloud->copy_count && scales_equally(&cloud->place); i++)
        lists += !scales_equally(&cloud->copies[i]);
    size_t each = count_primitives(source), copies = cloud->copy_count ? cloud->copy_count : 1;
    if (each && lists > (SHAPE_SCENE_PRIMITIVES_MAX - m->primitives) / each)
        cli_fail("more than %d primitives in the scene (make fewer; copies share theirs unless their scale "
                 "factors differ)",
                 SHAPE_SCENE_PRIMITIVES_MAX);
    if (source->cloud_count * copies > SHAPE_SCENE_CLOUDS_MAX - m->set->cloud_count)
        cli_fail("more than %d clouds in the scene (make fewer)", SHAPE_SCENE_CLOUDS_MAX);
}

static shape_set *new_set(void)
{
    shape_error error;
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    return set;
}

/* Adds the source's clouds, sharing the lists of those that stand in `set` from `first` on, and places them. */
static void add_sharing(shape_set *set, const shape_set *source, size_t first, const shape_transform *place)
{
    shape_error error;
    for (size_t i = 0; i < source->cloud_count; i++) {
        const shape_cloud *from = &source->clouds[i];
        size_t index;
        cli_check(shape_set_add_copy(set, first + i, &from->frame, &index, &error), &error);
        shape_cloud *cloud = &set->clouds[index];
        cloud->field = from->field;
        cloud->medium = from->medium;
        cli_check(shape_cloud_transform(cloud, place, &error), &error);
    }
}

/* The source once for each copy, copies of equal scaling with one list. */
static shape_set *place_copies(const shape_scene_cloud *cloud, const shape_set *source)
{
    shape_error error;
    shape_set *placed = new_set();
    size_t shared = SIZE_MAX;
    for (size_t k = 0; k < cloud->copy_count; k++) {
        const shape_transform *place = &cloud->copies[k];
        if (!scales_equally(place)) {
            shape_set *stretched = new_set();
            cli_check(shape_set_append(stretched, source, &error), &error);
            cli_check(shape_set_transform(stretched, NULL, place, &error), &error);
            cli_check(shape_set_append(placed, stretched, &error), &error);
            shape_set_destroy(stretched);
        } else if (shared == SIZE_MAX) {
            shared = placed->cloud_count;
            cli_check(shape_set_append(placed, source, &error), &error);
            for (size_t i = shared; i < placed->cloud_count; i++)
                cli_check(shape_cloud_transform(&placed->clouds[i], place, &error), &error);
        } else {
            add_sharing(placed, source, shared, place);
        }
    }
    return placed;
}

static bool moves(const shape_transform *place)
{
    const shape_transform still = shape_transform_defaults();
    return memcmp(place->scale, still.scale, sizeof still.scale) ||
           memcmp(place->rotate, still.rotate, sizeof still.rotate) ||
           memcmp(place->translate, still.translate, sizeof still.translate) || place->mirror[0] ||
           place->mirror[1] || place->mirror[2];
}

static void add_entry(maker *m, size_t index)
{
    const shape_scene_cloud *cloud = &m->scene->clouds[index];
    char place[512];
    shape_error error;
    snprintf(place, sizeof place, "%.400s: clouds[%zu]", m->shown, index);
    shape_set *source = make_source(m, cloud, place);
    describe(m, cloud, source, place);
    cli_set_place("%s: ", place);
    check_room(m, cloud, source);
    shape_set *placed = cloud->copy_count ? place_copies(cloud, source) : source;
    if (moves(&cloud->place))
        cli_check(shape_set_transform(placed, NULL, &cloud->place, &error), &error);
    cli_check(shape_set_append(m->set, placed, &error), &error);
    m->primitives += count_primitives(placed);
    if (placed != source)
        shape_set_destroy(placed);
    shape_set_destroy(source);
    cli_set_place("%s", "");
}

static size_t left_clouds;

void cli_scene_leave_edits(size_t clouds)
{
    left_clouds = clouds;
}

shape_set *cli_scene_make(const shape_scene *scene, const char *path)
{
    maker m = {
        .path = path, .shown = strcmp(path, "-") ? path : "standard input", .set = new_set(), .scene = scene};
    for (size_t i = 0; i < scene->cloud_count; i++) {
        cli_progress("making clouds", (double)i / (double)scene->cloud_count);
        add_entry(&m, i);
    }
    cli_progress("making clouds", 1);
    cli_scene_edit(scene, m.shown, left_clouds, m.set);
    return m.set;
}
