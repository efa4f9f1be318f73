/* neph-info: what is in a .neph file, as a table to read, JSON, or CSV with a row a primitive. */
#include <inttypes.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_scene.h"
#include "shape/file.h"
#include "shape/neph.h"

enum { MAX_ROWS = 10000000 };

/* A file that has been read, and where its clouds lie in the world. */
typedef struct report {
    const char *path;
    cli_input input;
    char format[32]; /* "neph 1.0" */
    size_t size;
    const shape_set *set;
    shape_box *boxes; /* a cloud's, in its own frame */
} report;

static const char *const model_names[] = {"uniform", "spheroid", "metaball", "layer", "grid"};
static const char *const bounds_names[] = {"sphere", "box", "altitudes"};
static const char *const noise_names[] = {"lattice", "perlin", "worley", "perlin-worley"};
static const char *const phase_names[] = {"hg", "isotropic", "rayleigh", "mie", "two-lobe"};

/* --- numbers: the shortest text that reads back as the same number --- */

static void print_float(FILE *out, float value)
{
    char text[32];
    for (int digits = 6; digits <= 9; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
        if (strtof(text, NULL) == value)
            break;
    }
    fputs(text, out);
}

static void print_double(FILE *out, double value)
{
    char text[32];
    for (int digits = 6; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    fputs(text, out);
}

static void print_doubles(FILE *out, const double *values, int count, const char *between)
{
    for (int i = 0; i < count; i++) {
        if (i)
            fputs(between, out);
        print_double(out, values[i]);
    }
}

/* --- reading --- */

static shape_box *find_boxes(const shape_set *set)
{
    shape_error error;
    shape_box *boxes = calloc(set->cloud_count ? set->cloud_count : 1, sizeof *boxes);
    if (!boxes)
        cli_fail("not enough memory");
    cli_check(shape_neph_bounds(set, boxes, &error), &error);
    return boxes;
}

static report read_report(const char *path)
{
    report r = {.path = strcmp(path, "-") ? path : "standard input", .input = cli_input_read(path)};
    r.size = r.input.size;
    r.set = r.input.set;
    if (r.input.scene)
        snprintf(r.format, sizeof r.format, "scene %d", SHAPE_SCENE_VERSION);
    else
        snprintf(r.format, sizeof r.format, "neph %u.%u", r.input.major, r.input.minor);
    r.boxes = find_boxes(r.set);
    return r;
}

/* World-space corners, min then max; false for an empty cloud. */
static bool cloud_bounds(const report *r, size_t cloud, double corners[6])
{
    shape_dvec3 min, max;
    if (shape_box_is_empty(r->boxes[cloud]))
        return false;
    shape_frame_box(&r->set->clouds[cloud].frame, r->boxes[cloud], &min, &max);
    const double found[6] = {min.x, min.y, min.z, max.x, max.y, max.z};
    memcpy(corners, found, sizeof found);
    return true;
}

static bool all_bounds(const report *r, double corners[6])
{
    bool any = false;
    for (size_t i = 0; i < r->set->cloud_count; i++) {
        double own[6];
        if (!cloud_bounds(r, i, own))
            continue;
        for (int k = 0; k < 6; k++)
            corners[k] = !any ? own[k] : k < 3 ? fmin(corners[k], own[k]) : fmax(corners[k], own[k]);
        any = true;
    }
    return any;
}

/* --- the table --- */

static const char *plural(size_t count)
{
    return count == 1 ? "" : "s";
}

static void print_bounds(FILE *out, const char *label, bool any, const double corners[6])
{
    if (!any) {
        fprintf(out, "%snothing inside\n", label);
        return;
    }
    fprintf(out, "%s%.8g, %.8g, %.8g to %.8g, %.8g, %.8g m; size %.6g x %.6g x %.6g m\n", label, corners[0],
            corners[1], corners[2], corners[3], corners[4], corners[5], corners[3] - corners[0],
            corners[4] - corners[1], corners[5] - corners[2]);
}

static void print_frame(FILE *out, const shape_frame *frame)
{
    const shape_frame identity = shape_frame_identity();
    bool moved_only = true;
    for (int i = 0; i < 3; i++)
        moved_only = moved_only && !memcmp(frame->m[i], identity.m[i], 3 * sizeof(double));
    const double origin[3] = {frame->m[0][3], frame->m[1][3], frame->m[2][3]};
    fprintf(out, "  frame       origin ");
    print_doubles(out, origin, 3, ", ");
    if (!moved_only) {
        fprintf(out, " m; axes ");
        for (int column = 0; column < 3; column++)
            fprintf(out, "%s(%.6g, %.6g, %.6g)", column ? " " : "", frame->m[0][column], frame->m[1][column],
                    frame->m[2][column]);
        fputc('\n', out);
    } else {
        fprintf(out, " m; not turned, not scaled\n");
    }
}

static void print_medium(FILE *out, const shape_medium *medium)
{
    fprintf(out, "  medium      extinction %g /m, albedo %g, phase %s", (double)medium->extinction,
            (double)medium->albedo, phase_names[medium->phase]);
    if (medium->phase == SHAPE_PHASE_HG || medium->phase == SHAPE_PHASE_TWO_LOBE)
        fprintf(out, ", g %g", (double)medium->g);
    if (medium->phase == SHAPE_PHASE_TWO_LOBE)
        fprintf(out, ", second lobe g %g of weight %g", (double)medium->g2, (double)medium->lobe_mix);
    if (medium->phase == SHAPE_PHASE_MIE)
        fprintf(out, ", droplets of %g micrometres", (double)medium->droplet);
    fputc('\n', out);
}

static void print_noise(FILE *out, const shape_field *field)
{
    fprintf(out, "  noise       %d octave%s, scale ", field->octaves, plural((size_t)field->octaves));
    if (field->noise_scale > 0)
        fprintf(out, "%g m", (double)field->noise_scale);
    else
        fprintf(out, "not chosen");
    fprintf(out, ", seed %" PRIu64, field->seed);
    if (field->model == SHAPE_MODEL_SPHEROID)
        fprintf(out, ", kappa %g", (double)field->kappa);
    if (field->model == SHAPE_MODEL_METABALL)
        fprintf(out, ", edge %g", (double)field->edge);
    fputc('\n', out);
}

static void print_cells(FILE *out, float scale, int otherwise)
{
    if (scale > 0)
        fprintf(out, ", cells of %g m", (double)scale);
    else
        fprintf(out, ", cells of %d noise scales", otherwise);
}

static void print_detail(FILE *out, const shape_field *field)
{
    const shape_detail *d = &field->detail;
    if (!shape_detail_is_on(d))
        return;
    const char *between = "";
    fputs("  details     ", out);
    if (d->smoothness > 0) {
        fprintf(out, "smoothness %g", (double)d->smoothness);
        between = "; ";
    }
    if (d->displace > 0) {
        fprintf(out, "%sdisplaced by %g m", between, (double)d->displace);
        print_cells(out, d->displace_scale, 5);
        between = "; ";
    }
    if (d->billow > 0 || d->wisp > 0) {
        fprintf(out, "%sbillow %g, wisp %g to a depth of %g radii", between, (double)d->billow,
                (double)d->wisp, d->detail_depth > 0 ? (double)d->detail_depth : 0.5);
        print_cells(out, d->detail_scale, 2);
    }
    fputc('\n', out);
}

static void print_layer(FILE *out, const shape_field *field)
{
    const shape_layer *l = &field->layer;
    if (field->model != SHAPE_MODEL_LAYER)
        return;
    fprintf(out, "  layer       %s of %s noise, coverage %g, ramp %g to %g", bounds_names[l->bounds],
            noise_names[l->noise], (double)l->coverage, (double)l->ramp[0], (double)l->ramp[1]);
    if (l->cut > 0)
        fprintf(out, ", cut %g", (double)l->cut);
    fprintf(out, ", stretch %g, %g, %g", (double)l->stretch[0], (double)l->stretch[1], (double)l->stretch[2]);
    if (l->noise != SHAPE_NOISE_WORLEY)
        fprintf(out, ", gain %g", (double)l->gain);
    if (l->noise >= SHAPE_NOISE_WORLEY)
        fprintf(out, ", Worley gain %g, frequency %g, %d octaves", (double)l->worley_gain,
                (double)l->worley_frequency, l->worley_octaves);
    if (l->noise == SHAPE_NOISE_PERLIN_WORLEY)
        fprintf(out, ", blend %g", (double)l->blend);
    fprintf(out, "\n  fades       falloff %g, bottom %g, top %g, sides %g", (double)l->falloff,
            (double)l->fade_bottom, (double)l->fade_top, (double)l->fade_side);
    if (l->planet_radius > 0)
        fprintf(out, "; %g m from the planet's centre", (double)l->planet_radius);
    fputc('\n', out);
}

/* The number (from 1) of the first cloud that has this cloud's list, where that is an earlier one; else 0. */
static size_t shared_with(const shape_set *set, size_t cloud, const size_t *first)
{
    size_t earlier = first[set->clouds[cloud].list];
    return earlier < cloud ? earlier + 1 : 0;
}

static void print_cloud(FILE *out, const report *r, size_t index, const size_t *first)
{
    const shape_cloud *cloud = &r->set->clouds[index];
    const shape_primitives *list = shape_set_list_const(r->set, index);
    double corners[6];
    fprintf(out, "\ncloud %zu: %s\n", index + 1, cloud->name);
    fprintf(out, "  model       %s\n", model_names[cloud->field.model]);
    fprintf(out, "  primitives  %zu: %zu sphere%s, %zu ellipsoid%s", shape_primitives_count(list),
            list->sphere_count, plural(list->sphere_count), list->ellipsoid_count,
            plural(list->ellipsoid_count));
    size_t other = shared_with(r->set, index, first);
    if (other)
        fprintf(out, " (those of cloud %zu)", other);
    fputc('\n', out);
    bool any = cloud_bounds(r, index, corners);
    print_bounds(out, "  bounds      ", any, corners);
    print_frame(out, &cloud->frame);
    print_medium(out, &cloud->medium);
    print_noise(out, &cloud->field);
    print_detail(out, &cloud->field);
    print_layer(out, &cloud->field);
    fprintf(out, "  seed        %" PRIu64 "\n", cloud->seed);
    fprintf(out, "  made by     %s\n", cloud->made_by[0] ? cloud->made_by : "not said");
}

static size_t *first_clouds(const shape_set *set)
{
    size_t *first = malloc((set->list_count ? set->list_count : 1) * sizeof *first);
    if (!first)
        cli_fail("not enough memory");
    for (size_t i = set->cloud_count; i > 0; i--)
        first[set->clouds[i - 1].list] = i - 1;
    return first;
}

/* Of all clouds; copies count again. */
static size_t count_primitives(const shape_set *set)
{
    size_t count = 0;
    for (size_t i = 0; i < set->cloud_count; i++)
        count += shape_primitives_count(shape_set_list_const(set, i));
    return count;
}

static void print_table(FILE *out, const report *r)
{
    const shape_set *set = r->set;
    size_t primitives = count_primitives(set);
    fprintf(out, "%s: %s, %zu bytes, %zu cloud%s, %zu primitive%s\n", r->path, r->format, r->size,
            set->cloud_count, plural(set->cloud_count), primitives, plural(primitives));
    double corners[6];
    bool any = all_bounds(r, corners);
    print_bounds(out, "bounds ", any, corners);
    for (size_t i = 0; i < set->extra_count; i++)
        fprintf(out, "a chunk that this version does not know: %.4s, %zu bytes\n", set->extras[i].type,
                set->extras[i].size);
    for (size_t i = 0; r->input.scene && i < r->input.scene->mesh_count; i++)
        fprintf(out, "opaque mesh %zu: %s\n", i + 1, r->input.scene->meshes[i].file);
    size_t *first = first_clouds(set);
    for (size_t i = 0; i < set->cloud_count; i++)
        print_cloud(out, r, i, first);
    free(first);
}

/* --- JSON: jansson quotes the texts; it has no unsigned 64-bit numbers and no short floats, so numbers are written
 * here --- */

static void print_json_text(FILE *out, const char *text)
{
    json_t *string = json_string(text);
    char *quoted = string ? json_dumps(string, JSON_ENCODE_ANY) : NULL;
    if (!quoted)
        cli_fail("not enough memory");
    fputs(quoted, out);
    free(quoted);
    json_decref(string);
}

static void print_json_row(FILE *out, const double *values, int count, bool last)
{
    fputc('[', out);
    print_doubles(out, values, count, ", ");
    fputs(last ? "]" : "], ", out);
}

static void print_json_medium(FILE *out, const shape_cloud *cloud)
{
    const shape_field *field = &cloud->field;
    const shape_medium *medium = &cloud->medium;
    const struct {
        const char *key;
        float value;
    } floats[] = {{"extinction", medium->extinction},
                  {"albedo", medium->albedo},
                  {"g", medium->g},
                  {"g2", medium->g2},
                  {"lobe_mix", medium->lobe_mix},
                  {"droplet", medium->droplet},
                  {"kappa", field->kappa},
                  {"noise_scale", field->noise_scale},
                  {"edge", field->edge}};
    fprintf(out, "{\"phase\": \"%s\"", phase_names[medium->phase]);
    for (size_t i = 0; i < sizeof floats / sizeof *floats; i++) {
        fprintf(out, ", \"%s\": ", floats[i].key);
        print_float(out, floats[i].value);
    }
    fprintf(out, ", \"octaves\": %d, \"noise_seed\": %" PRIu64 "}", field->octaves, field->seed);
}

/* A key and a number, behind others. */
typedef struct json_float {
    const char *key;
    float value;
} json_float;

static void print_json_floats(FILE *out, const json_float *floats, size_t count, const char *between)
{
    for (size_t i = 0; i < count; i++) {
        fprintf(out, "%s\"%s\": ", i ? ", " : between, floats[i].key);
        print_float(out, floats[i].value);
    }
}

/* Only where there is something to say. */
static void print_json_detail(FILE *out, const shape_detail *d)
{
    const json_float floats[] = {{"smoothness", d->smoothness},
                                 {"displace", d->displace},
                                 {"displace_scale", d->displace_scale},
                                 {"billow", d->billow},
                                 {"wisp", d->wisp},
                                 {"detail_depth", d->detail_depth},
                                 {"detail_scale", d->detail_scale}};
    if (!shape_detail_is_on(d))
        return;
    fputs(",\n     \"detail\": {", out);
    print_json_floats(out, floats, sizeof floats / sizeof *floats, "");
    fputc('}', out);
}

static void print_json_layer(FILE *out, const shape_layer *l)
{
    const json_float floats[] = {{"blend", l->blend},
                                 {"gain", l->gain},
                                 {"worley_gain", l->worley_gain},
                                 {"worley_frequency", l->worley_frequency},
                                 {"coverage", l->coverage},
                                 {"cut", l->cut},
                                 {"falloff", l->falloff},
                                 {"fade_bottom", l->fade_bottom},
                                 {"fade_top", l->fade_top},
                                 {"fade_side", l->fade_side},
                                 {"planet_radius", l->planet_radius}};
    const double stretch[3] = {(double)l->stretch[0], (double)l->stretch[1], (double)l->stretch[2]};
    const double ramp[2] = {(double)l->ramp[0], (double)l->ramp[1]};
    fprintf(out, ",\n     \"layer\": {\"bounds\": \"%s\", \"noise\": \"%s\", \"worley_octaves\": %d",
            bounds_names[l->bounds], noise_names[l->noise], l->worley_octaves);
    print_json_floats(out, floats, sizeof floats / sizeof *floats, ", ");
    fputs(", \"stretch\": ", out);
    print_json_row(out, stretch, 3, true);
    fputs(", \"ramp\": ", out);
    print_json_row(out, ramp, 2, true);
    fputc('}', out);
}

static void print_json_cloud(FILE *out, const report *r, size_t index)
{
    const shape_cloud *cloud = &r->set->clouds[index];
    const shape_primitives *list = shape_set_list_const(r->set, index);
    double corners[6];
    fputs("\n    {\"name\": ", out);
    print_json_text(out, cloud->name);
    fprintf(
        out,
        ", \"model\": \"%s\", \"primitives\": %zu, \"spheres\": %zu, \"ellipsoids\": %zu,\n     \"bounds\": ",
        model_names[cloud->field.model], shape_primitives_count(list), list->sphere_count,
        list->ellipsoid_count);
    if (cloud_bounds(r, index, corners)) {
        fputc('[', out);
        print_json_row(out, corners, 3, false);
        print_json_row(out, corners + 3, 3, true);
        fputc(']', out);
    } else {
        fputs("null", out);
    }
    fputs(",\n     \"frame\": [", out);
    for (int i = 0; i < 3; i++)
        print_json_row(out, cloud->frame.m[i], 4, i == 2);
    fputs("],\n     \"medium\": ", out);
    print_json_medium(out, cloud);
    print_json_detail(out, &cloud->field.detail);
    if (cloud->field.model == SHAPE_MODEL_LAYER)
        print_json_layer(out, &cloud->field.layer);
    fprintf(out, ",\n     \"seed\": %" PRIu64 ", \"made_by\": ", cloud->seed);
    print_json_text(out, cloud->made_by);
    fputc('}', out);
}

static void print_json(FILE *out, const report *r)
{
    fprintf(out, "{\"format\": \"%s\", \"bytes\": %zu, \"clouds\": [", r->format, r->size);
    for (size_t i = 0; i < r->set->cloud_count; i++) {
        if (i)
            fputc(',', out);
        print_json_cloud(out, r, i);
    }
    fputc(']', out);
    for (size_t i = 0; r->input.scene && i < r->input.scene->mesh_count; i++) {
        fputs(i ? ", {\"file\": " : ",\n  \"meshes\": [{\"file\": ", out);
        print_json_text(out, r->input.scene->meshes[i].file);
        fputs(i + 1 == r->input.scene->mesh_count ? "}]" : "}", out);
    }
    fputs("}\n", out);
}

/* --- CSV (RFC 4180) --- */

static char *quote_csv(const char *text)
{
    char *quoted = malloc(2 * strlen(text) + 3), *to = quoted;
    if (!quoted)
        cli_fail("not enough memory");
    bool needed = strpbrk(text, ",\"") != NULL;
    if (needed)
        *to++ = '"';
    for (; *text; text++) {
        if (*text == '"')
            *to++ = '"';
        *to++ = *text;
    }
    if (needed)
        *to++ = '"';
    *to = 0;
    return quoted;
}

/* Nine digits tell any two floats apart. */
static void print_csv_row(FILE *out, const char *cloud, const char *kind, const float values[10])
{
    fprintf(out, "%s,%s", cloud, kind);
    for (int i = 0; i < 10; i++)
        fprintf(out, ",%.9g", (double)values[i]);
    fputc('\n', out);
}

static void print_csv(FILE *out, const report *r)
{
    fputs("cloud,kind,x,y,z,a,b,c,qx,qy,qz,qw\n", out);
    for (size_t i = 0; i < r->set->cloud_count && !ferror(out); i++) {
        const shape_primitives *list = shape_set_list_const(r->set, i);
        char *name = quote_csv(r->set->clouds[i].name);
        for (size_t k = 0; k < list->sphere_count; k++) {
            const shape_sphere *s = &list->spheres[k];
            const float values[10] = {s->x, s->y, s->z, s->radius, s->radius, s->radius, 0, 0, 0, 1};
            print_csv_row(out, name, "sphere", values);
        }
        for (size_t k = 0; k < list->ellipsoid_count; k++) {
            const shape_ellipsoid *e = &list->ellipsoids[k];
            const float values[10] = {e->x, e->y, e->z, e->a, e->b, e->c, e->q.x, e->q.y, e->q.z, e->q.w};
            print_csv_row(out, name, "ellipsoid", values);
        }
        free(name);
    }
}

static bool as_json, as_csv;

static const cli_option form_options[] = {
    {"json", 0, CLI_FLAG, &as_json, 0, 0, NULL, "one JSON object; bounds in world space [off]", NULL, true},
    {"csv", 0, CLI_FLAG, &as_csv, 0, 0, NULL, "a row a primitive, in the cloud's frame [off]", NULL, true},
    {0}};

static const cli_group groups[] = {{"Form", form_options}, {"Scene", cli_outside_options}, {0}};

static const cli_program program = {.name = "neph-info",
                                    .arguments = "FILE",
                                    .about =
                                        "Shows what is in a .neph, or what a scene (docs/scene.md) makes: "
                                        "clouds, primitives, bounds,\n"
                                        "frames, media, provenance. FILE may be -.",
                                    .examples = "  neph-info castellanus.neph\n"
                                                "  neph-gauss | neph-info --json -\n"
                                                "  neph-info --csv castellanus.neph -o spheres.csv\n",
                                    .min_arguments = 1,
                                    .max_arguments = 1,
                                    .groups = groups};

static void print_report(FILE *out, const report *r)
{
    if (as_json)
        print_json(out, r);
    else if (as_csv)
        print_csv(out, r);
    else
        print_table(out, r);
}

/* A file appears whole or not at all, so its text is held in memory. A few bytes can name a million primitives a
 * thousand times; then the rows go to standard output, where nothing is held. */
static void write_report(const cli_common *common, const report *r)
{
    char *text = NULL;
    size_t size = 0;
    if (as_csv && count_primitives(r->set) > MAX_ROWS)
        cli_fail(
            "%s: %zu rows are too many for -o, which takes %d (leave out -o and send the output to a file)",
            r->path, count_primitives(r->set), MAX_ROWS);
    FILE *out = open_memstream(&text, &size);
    if (!out)
        cli_fail("not enough memory");
    print_report(out, r);
    bool failed = ferror(out);
    if (fclose(out) || failed)
        cli_fail("not enough memory");
    cli_write(common, text, size, false);
    free(text);
}

int main(int argc, char **argv)
{
    cli_common common;
    cli_parse(&program, argc, argv, &common);
    if (as_json && as_csv)
        cli_wrong("--json and --csv exclude each other (give one of them)");
    report r = read_report(common.arguments[0]);
    if (!strcmp(common.output, "-"))
        print_report(stdout, &r);
    else
        write_report(&common, &r);
    free(r.boxes);
    cli_input_free(&r.input);
    return cli_finish(&common);
}
