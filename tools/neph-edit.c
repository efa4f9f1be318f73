/* neph-edit: combines clouds, moves them, and reworks their primitives. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"
#include "shape/combine.h"
#include "shape/gaussian.h"
#include "shape/prune.h"
#include "shape/refine.h"
#include "shape/simplify.h"
#include "shape/transform.h"

static struct {
    double translate[3], rotate[3], scale[3], pivot[3];
    bool keep_depth, hollow, prune, grow, clip;
    int64_t leave_edits, thin, grow_levels, grow_count, primitives;
    double simplify;
    double grow_ratio[2], clip_height, clip_normal[3], clip_noise, clip_size;
    const char *cloud, *mirror;
    bool translate_given, rotate_given, scale_given, pivot_given, thin_given, clip_height_given;
    bool simplify_given, primitives_given;
    bool grow_levels_given, grow_count_given, grow_ratio_given, clip_normal_given, clip_noise_given,
        clip_size_given;
} values = {.scale = {1, 1, 1},
            .grow_levels = 2,
            .grow_count = 10,
            .grow_ratio = {0.35, 0.6},
            .clip_normal = {0, 1, 0},
            .clip_size = 1};

static const cli_option place_options[] = {
    {"cloud", 0, CLI_TEXT, &values.cloud, 0, 0, "NAME", "change this cloud only [all]", NULL, false},
    {"scale", 0, CLI_VECTOR, &values.scale, 1e-6, 1e6, "X,Y,Z",
     "factors along the world's axes; unequal ones make ellipsoids [1,1,1]", &values.scale_given, false},
    {"keep-depth", 0, CLI_FLAG, &values.keep_depth, 0, 0, NULL,
     "divide the extinction by the scale, so that the optical depth stays", NULL, false},
    {"mirror", 0, CLI_TEXT, &values.mirror, 0, 0, "AXES",
     "turn axes round: x, y, z or several of them [none]", NULL, false},
    {"rotate", 0, CLI_VECTOR, &values.rotate, -1e6, 1e6, "X,Y,Z", "degrees about x, then y, then z [0,0,0]",
     &values.rotate_given, false},
    {"translate", 0, CLI_VECTOR, &values.translate, -1e12, 1e12, "X,Y,Z", "metres [0,0,0]",
     &values.translate_given, false},
    {"pivot", 0, CLI_VECTOR, &values.pivot, -1e12, 1e12, "X,Y,Z",
     "the point that scale, mirror and rotate leave in place [0,0,0]", &values.pivot_given, false},
    {"leave-edits", 0, CLI_INTEGER, &values.leave_edits, 0, 1e9, "N",
     "of a scene: leave the edits of its first N clouds to whoever shows them [0]", NULL, true},
    {0}};

static const cli_option rework_options[] = {
    {"grow", 0, CLI_FLAG, &values.grow, 0, 0, NULL, "set smaller spheres on the surface, level by level",
     NULL, false},
    {"grow-levels", 0, CLI_INTEGER, &values.grow_levels, 1, 8, "N", "levels [2]", &values.grow_levels_given,
     false},
    {"grow-count", 0, CLI_INTEGER, &values.grow_count, 1, 1000, "N",
     "spheres tried on each primitive of the level before [10]", &values.grow_count_given, false},
    {"grow-ratio", 0, CLI_RANGE, &values.grow_ratio, 0.01, 1, NULL,
     "their radius as a share of the one below, or a range of it [0.35..0.6]", &values.grow_ratio_given,
     false},
    {"clip", 0, CLI_FLAG, &values.clip, 0, 0, NULL, "cut by a plane: a flat base, or a ragged one", NULL,
     false},
    {"clip-height", 0, CLI_NUMBER, &values.clip_height, -1e12, 1e12, "H",
     "the plane's height along its normal, metres, world [the lowest centre's]", &values.clip_height_given,
     false},
    {"clip-normal", 0, CLI_VECTOR, &values.clip_normal, -1e6, 1e6, "X,Y,Z",
     "to the side that is kept [0,1,0]", &values.clip_normal_given, false},
    {"clip-noise", 0, CLI_NUMBER, &values.clip_noise, 0, 1e6, "L",
     "how far a ragged base hangs down, metres [0]", &values.clip_noise_given, false},
    {"clip-size", 0, CLI_NUMBER, &values.clip_size, 1e-6, 1e9, "L", "size of the rags, metres [1]",
     &values.clip_size_given, false},
    {"hollow", 0, CLI_FLAG, &values.hollow, 0, 0, NULL, "leave out the primitives of the core", NULL, false},
    {"thin", 0, CLI_INTEGER, &values.thin, 1, 1000000000, "N",
     "keep N primitives a cloud, chosen at random [all]", &values.thin_given, false},
    {"prune", 0, CLI_FLAG, &values.prune, 0, 0, NULL, "leave out primitives that lie inside others", NULL,
     false},
    {"simplify", 0, CLI_NUMBER, &values.simplify, 0, 1, "E",
     "merge and drop primitives while pictures change by at most E, such as 0.03 [not]",
     &values.simplify_given, false},
    {"primitives", 0, CLI_INTEGER, &values.primitives, 1, 1000000000, "N",
     "the same down to N primitives a cloud, whatever the change [all]", &values.primitives_given, false},
    {0}};

/* The medium's options keep what a cloud has, so their help must not promise a default. */
static cli_option medium_options[64];
static char medium_help[64][160];

static const cli_group groups[] = {{"Which, and where to", place_options},
                                   {"Rework", rework_options},
                                   {"Medium and frame, where given", medium_options},
                                   {"Scene", cli_scene_options},
                                   {0}};

static const cli_program program = {
    .name = "neph-edit",
    .arguments = "FILE...",
    .about = "Combines the clouds of several .neph files or scenes into one, and changes all of them or one. "
             "Whatever the "
             "order of the\n"
             "options, the order of work is: scale, mirror, rotate, translate; grow; clip; hollow; thin; "
             "prune; medium; simplify.\n"
             "All of the first but unequal scaling acts on a cloud's frame and carries its noise along. "
             "Extinction is per\n"
             "metre of the world: a cloud twice as large is twice as deep, unless --keep-depth is given.",
    .examples = "  neph-edit a.neph b.neph -o both.neph\n"
                "  neph-gauss | neph-edit - --scale 2,1,1 --rotate 0,30,0 -o long.neph\n"
                "  neph-edit cumulus.neph --grow --clip --clip-height -1.5 -o detailed.neph\n"
                "  neph-edit detailed.neph --simplify 0.03 -o far.neph\n",
    .min_arguments = 1,
    .max_arguments = 10000,
    .groups = groups};

static void prepare_medium_options(void)
{
    for (size_t i = 0; cli_medium_options[i].name && i + 1 < sizeof medium_options / sizeof *medium_options;
         i++) {
        medium_options[i] = cli_medium_options[i];
        const char *help = cli_medium_options[i].help, *bracket = strrchr(help, '[');
        snprintf(medium_help[i], sizeof medium_help[i], "%.*s[as it is]", bracket ? (int)(bracket - help) : 0,
                 help);
        medium_options[i].help = medium_help[i];
    }
}

static shape_transform transform_in_force(void)
{
    shape_transform transform = shape_transform_defaults();
    memcpy(transform.scale, values.scale, sizeof values.scale);
    memcpy(transform.rotate, values.rotate, sizeof values.rotate);
    memcpy(transform.translate, values.translate, sizeof values.translate);
    memcpy(transform.pivot, values.pivot, sizeof values.pivot);
    transform.keep_depth = values.keep_depth;
    if (values.mirror && (!*values.mirror || values.mirror[strspn(values.mirror, "xyz")]))
        cli_wrong("--mirror \"%s\": expected x, y, z or several of them", values.mirror);
    for (const char *axis = values.mirror; axis && *axis; axis++)
        transform.mirror[*axis - 'x'] = true;
    return transform;
}

static shape_clip clip_in_force(uint64_t seed)
{
    shape_clip options = shape_clip_defaults();
    memcpy(options.normal, values.clip_normal, sizeof values.clip_normal);
    options.lowest = !values.clip_height_given;
    options.height = values.clip_height;
    options.noise = values.clip_noise;
    options.noise_size = values.clip_size;
    options.seed = seed;
    return options;
}

static shape_grow grow_in_force(void)
{
    shape_grow options = shape_grow_defaults();
    options.levels = (int)values.grow_levels;
    options.count = (int)values.grow_count;
    memcpy(options.ratio, values.grow_ratio, sizeof values.grow_ratio);
    return options;
}

/* A scene of one file, the one that was written. */
static void save_scene(const cli_common *common)
{
    shape_error error;
    shape_scene_cloud *cloud;
    if (!cli_save_wanted())
        return;
    shape_scene *scene = shape_scene_create(&error);
    if (!scene)
        cli_fail("%s", error.text);
    cli_check(shape_scene_add_cloud(scene, &cloud, &error), &error);
    cloud->file = cli_save_name(common->output);
    cli_save_scene(scene);
    shape_scene_destroy(scene);
}

/* Finds a wrong command before anything is read. Options that do nothing without another one are mistakes too. */
static void check_command(void)
{
    shape_error error;
    shape_transform transform = transform_in_force();
    shape_clip clipping = clip_in_force(0);
    shape_grow growing = grow_in_force();
    if (shape_transform_check(&transform, &error) || shape_clip_check(&clipping, &error) ||
        shape_grow_check(&growing, &error))
        cli_wrong("%s", error.text);
    if (!values.grow && (values.grow_levels_given || values.grow_count_given || values.grow_ratio_given))
        cli_wrong("the --grow-... options say how to --grow (give --grow too)");
    if (!values.clip && (values.clip_height_given || values.clip_normal_given || values.clip_noise_given ||
                         values.clip_size_given))
        cli_wrong("the --clip-... options say how to --clip (give --clip too)");
    if (values.clip_size_given && !(values.clip_noise > 0))
        cli_wrong("--clip-size is the size of the rags that --clip-noise makes (give --clip-noise too)");
    if (values.keep_depth && !values.scale_given)
        cli_wrong("--keep-depth goes with --scale");
    if (values.pivot_given && !values.scale_given && !values.rotate_given && !values.mirror)
        cli_wrong("--pivot goes with --scale, --mirror or --rotate");
}

static shape_set *read_all(const cli_common *common)
{
    static const char edit_leaves_meshes[] = "left out, since a .neph holds clouds only";
    int from_stdin = 0;
    for (int i = 0; i < common->argument_count; i++)
        from_stdin += !strcmp(common->arguments[i], "-");
    if (from_stdin > 1)
        cli_wrong("standard input can be read once only (name the other inputs)");
    shape_error error;
    cli_input all = cli_input_read(common->arguments[0]);
    cli_note_meshes(all.scene, edit_leaves_meshes);
    for (int i = 1; i < common->argument_count; i++) {
        cli_input next = cli_input_read(common->arguments[i]);
        cli_note_meshes(next.scene, edit_leaves_meshes);
        cli_check(shape_set_append(all.set, next.set, &error), &error);
        cli_input_free(&next);
    }
    shape_scene_destroy(all.scene);
    return all.set;
}

/* Which clouds --cloud means; the caller frees the array. */
static bool *select_clouds(const shape_set *set)
{
    bool *selected = calloc(set->cloud_count + 1, sizeof *selected);
    if (!selected)
        cli_fail("not enough memory");
    bool any = !values.cloud;
    for (size_t i = 0; i < set->cloud_count; i++) {
        selected[i] = !values.cloud || !strcmp(set->clouds[i].name, values.cloud);
        any = any || selected[i];
    }
    if (!any)
        cli_fail("there is no cloud \"%s\" (neph-info shows the names)", values.cloud);
    return selected;
}

static void place(shape_set *set, const bool *selected)
{
    shape_transform transform = transform_in_force();
    shape_error error;
    cli_check(shape_set_transform(set, selected, &transform, &error), &error);
}

/* Every cloud that shares a list is told the same. */
static shape_status describe_alike(const shape_set *set, size_t cloud, void *key, void *context,
                                   shape_error *error)
{
    (void)set, (void)cloud, (void)key, (void)context, (void)error;
    return SHAPE_OK;
}

typedef struct tally {
    uint64_t seed;
    size_t grown, hollowed, thinned, pruned;
} tally;

static shape_status grow(shape_primitives *list, uint32_t number, const void *key, void *context,
                         shape_error *error)
{
    (void)key;
    tally *sum = context;
    shape_grow options = grow_in_force();
    size_t added;
    shape_status status =
        shape_primitives_grow(list, &options, shape_field_seed(sum->seed, number), &added, error);
    sum->grown += added;
    return status;
}

/* The steps that only take away. */
static shape_status reduce(shape_primitives *list, uint32_t number, const void *key, void *context,
                           shape_error *error)
{
    (void)key;
    tally *sum = context;
    if (values.hollow) {
        shape_core core = shape_primitives_core(list);
        sum->hollowed += shape_primitives_hollow(list, &core);
    }
    if (values.thin_given)
        sum->thinned += shape_primitives_thin(list, (size_t)values.thin, shape_field_seed(sum->seed, number));
    size_t pruned = 0;
    shape_status status = values.prune ? shape_primitives_prune(list, &pruned, error) : SHAPE_OK;
    sum->pruned += pruned;
    return status;
}

static void clip(shape_set *set, const bool *selected, uint64_t seed)
{
    shape_clip options = clip_in_force(seed);
    size_t removed, squashed;
    shape_error error;
    cli_check(shape_set_clip(set, selected, &options, &removed, &squashed, &error), &error);
    cli_say("clipping removed %zu primitives and squashed %zu", removed, squashed);
}

static void rework(shape_set *set, const bool *selected, uint64_t seed)
{
    shape_error error;
    tally sum = {.seed = seed};
    shape_list_change growing = {0, describe_alike, grow, &sum}, reducing = {0, describe_alike, reduce, &sum};
    if (values.grow) {
        cli_check(shape_set_change_lists(set, selected, &growing, &error), &error);
        cli_say("growing added %zu spheres", sum.grown);
    }
    if (values.clip)
        clip(set, selected, seed);
    if (values.hollow || values.thin_given || values.prune)
        cli_check(shape_set_change_lists(set, selected, &reducing, &error), &error);
    if (values.hollow)
        cli_say("hollowing removed %zu primitives", sum.hollowed);
    if (values.thin_given)
        cli_say("thinning out removed %zu primitives", sum.thinned);
    if (values.prune)
        cli_say("pruning removed %zu primitives", sum.pruned);
    bool metaballs = false;
    for (size_t i = 0; i < set->cloud_count; i++)
        metaballs = metaballs || (selected[i] && set->clouds[i].field.model == SHAPE_MODEL_METABALL);
    if (sum.pruned && metaballs)
        cli_say("note: the field of metaballs is a sum over all of them, so pruning made it thinner");
}

/* All that a simplification depends on, besides the list. Made zero first, since keys are compared byte by byte. */
static shape_status describe_look(const shape_set *set, size_t cloud, void *key, void *context,
                                  shape_error *error)
{
    (void)context, (void)error;
    const shape_cloud *from = &set->clouds[cloud];
    shape_cloud *look = key;
    memset(look, 0, sizeof *look);
    look->field.model = from->field.model;
    look->field.kappa = from->field.kappa;
    look->field.octaves = from->field.octaves;
    look->field.noise_scale = from->field.noise_scale;
    look->field.edge = from->field.edge;
    look->field.seed = from->field.seed;
    look->field.detail = from->field.detail;
    look->medium.extinction = from->medium.extinction;
    for (int k = 0; k < 3; k++) {
        shape_dvec3 axis = {from->frame.m[0][k], from->frame.m[1][k], from->frame.m[2][k]};
        look->frame.m[k][k] = shape_dvec3_length(axis);
    }
    return SHAPE_OK;
}

typedef struct simplified {
    size_t before, after;
    double change;
} simplified;

static shape_status simplify_list(shape_primitives *list, uint32_t number, const void *key, void *context,
                                  shape_error *error)
{
    (void)number;
    simplified *sum = context;
    shape_cloud look;
    memcpy(&look, key, sizeof look);
    shape_simplify_options options = shape_simplify_defaults();
    if (values.simplify_given)
        options.error = values.simplify;
    options.most = values.primitives_given ? (size_t)values.primitives : 0;
    shape_simplify_result result;
    shape_status status = shape_primitives_simplify(list, &look, &options, &result, error);
    if (status)
        return status;
    sum->before += result.before;
    sum->after += result.after;
    sum->change = result.error > sum->change ? result.error : sum->change;
    return SHAPE_OK;
}

static void simplify(shape_set *set, const bool *selected)
{
    if (!values.simplify_given && !values.primitives_given)
        return;
    simplified sum = {0};
    shape_error error;
    shape_list_change change = {sizeof(shape_cloud), describe_look, simplify_list, &sum};
    cli_check(shape_set_change_lists(set, selected, &change, &error), &error);
    cli_say("simplifying kept %zu of %zu primitives; pictures change by %.2g%s", sum.after, sum.before,
            sum.change,
            values.simplify_given && sum.change > values.simplify
                ? ", more than --simplify allows, for --primitives"
                : "");
}

/* This program's line, and behind it, as far as it fits, how the cloud came to be. */
static void note_provenance(shape_cloud *cloud, const char *made_by)
{
    char whole[2 * SHAPE_MADE_BY_MAX + 16];
    snprintf(whole, sizeof whole, "%s%s%s", made_by, *cloud->made_by ? " <- " : "", cloud->made_by);
    size_t length = strlen(whole);
    if (length > SHAPE_MADE_BY_MAX) {
        length = SHAPE_MADE_BY_MAX;
        while (length && ((unsigned char)whole[length] & 0xc0) == 0x80)
            length--;
    }
    memset(cloud->made_by, 0, sizeof cloud->made_by);
    memcpy(cloud->made_by, whole, length);
}

int main(int argc, char **argv)
{
    cli_common common;
    prepare_medium_options();
    cli_parse(&program, argc, argv, &common);
    cli_scene_leave_edits((size_t)values.leave_edits);
    check_command();
    cli_save_check(&common);
    if (cli_save_wanted() && !strcmp(common.output, "-"))
        cli_wrong("--save-scene names the file that is written (give -o FILE)");
    shape_set *set = read_all(&common);
    bool *selected = select_clouds(set);
    place(set, selected);
    rework(set, selected, common.seed);
    char made_by[SHAPE_MADE_BY_MAX + 1] = "";
    cli_made_by(made_by);
    size_t primitives = 0;
    shape_error error;
    for (size_t i = 0; i < set->cloud_count; i++) {
        if (selected[i]) {
            cli_medium_apply(&set->clouds[i]);
            cli_check(shape_cloud_choose_noise_scale(&set->clouds[i], shape_set_list(set, i), &error),
                      &error);
        }
        note_provenance(&set->clouds[i], made_by);
    }
    simplify(set, selected);
    for (size_t i = 0; i < set->cloud_count; i++)
        primitives += shape_primitives_count(shape_set_list(set, i));
    cli_say("%zu cloud%s, %zu primitives", set->cloud_count, set->cloud_count == 1 ? "" : "s", primitives);
    cli_write_set(&common, set);
    save_scene(&common);
    free(selected);
    shape_set_destroy(set);
    return cli_finish(&common);
}
