/* A volume to primitives, with sizes, compression and errors told. */
#include "cli_vdb_fit.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_volume.h"
#include "shape/file.h"
#include "shape/march.h"
#include "shape/neph.h"
#include "shape/volumefit.h"

cli_vdb_fit_settings cli_vdb_fit_values = {.primitives = 64, .cells = 80};

static bool show_progress(void *context, double done)
{
    (void)context;
    cli_progress("fitting", done < 0.9999 ? done : 0.9999);
    return true;
}

enum { SIDE = 96 };

/* A picture from far along one axis, marched, sunlit, with all scatterings, before black. */
static void take_picture(const shape_volume *volume, shape_dvec3 middle, double size, int side,
                         float *picture)
{
    shape_error error;
    shape_marcher *marcher;
    shape_view view = shape_view_defaults();
    shape_light light = shape_light_defaults();
    shape_march_options options = shape_march_defaults();
    double away[3] = {0, 0, 0};
    light.sky = SHAPE_SKY_NONE;
    away[side / 2] = side % 2 ? -1 : 1;
    view.width = view.height = SIDE;
    view.fov = 20;
    view.target = middle;
    view.eye = shape_dvec3_add(
        middle, shape_dvec3_scale(shape_dvec3_make(away[0], away[1], away[2]), 0.5 * size / tan(0.1745)));
    options.step = size / 150;
    options.resolution = 32;
    cli_check(shape_marcher_create(volume, &light, view.eye, &options, &marcher, &error), &error);
    cli_check(shape_march_render(marcher, &view, picture, NULL, &error), &error);
    shape_marcher_destroy(marcher);
}

/* The RMSE of linear radiance from six sides, and the mean radiance of the first volume's pictures. */
static double picture_error(const shape_set *a, const shape_set *b, double *mean)
{
    enum { VALUES = SIDE * SIDE * 3 };
    shape_error error;
    shape_volume *first, *second;
    shape_dvec3 low = {0, 0, 0}, high = {1, 1, 1};
    double squares = 0, sum = 0;
    shape_set_bounds(a, &low, &high);
    shape_dvec3 side = shape_dvec3_sub(high, low),
                middle = shape_dvec3_scale(shape_dvec3_add(low, high), 0.5);
    cli_check(shape_volume_create(a, &first, &error), &error);
    cli_check(shape_volume_create(b, &second, &error), &error);
    float *pictures = malloc(2 * VALUES * sizeof *pictures);
    if (!pictures)
        cli_fail("not enough memory for the pictures");
    for (int i = 0; i < 6; i++) {
        take_picture(first, middle, shape_dvec3_length(side), i, pictures);
        take_picture(second, middle, shape_dvec3_length(side), i, pictures + VALUES);
        for (int k = 0; k < VALUES; k++) {
            double miss = (double)pictures[k] - (double)pictures[VALUES + k];
            squares += miss * miss;
            sum += (double)pictures[k];
        }
    }
    free(pictures);
    shape_volume_destroy(first);
    shape_volume_destroy(second);
    *mean = sum / (6 * VALUES);
    return sqrt(squares / (6 * VALUES));
}

static size_t file_size(const char *path)
{
    FILE *file = fopen(path, "rb");
    long size = file && !fseek(file, 0, SEEK_END) ? ftell(file) : 0;
    if (file)
        fclose(file);
    return size > 0 ? (size_t)size : 0;
}

static shape_volumefit_options fit_options(void)
{
    shape_volumefit_options options = shape_volumefit_defaults();
    const cli_vdb_fit_settings *v = &cli_vdb_fit_values;
    options.primitives = (size_t)(v->error_given && !v->primitives_given ? 1000 : v->primitives);
    options.error = v->error_given ? v->error : 0;
    options.resolution = (int)v->cells;
    options.model = v->model ? SHAPE_MODEL_SPHEROID : SHAPE_MODEL_UNIFORM;
    options.progress = show_progress;
    return options;
}

static void report(const cli_common *common, size_t source, const shape_set *from, const shape_set *fit,
                   const shape_volumefit_report *r)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    double mean, rmse;
    if (common->quiet)
        return;
    cli_check(shape_neph_encode(fit, &bytes, &size, &error), &error);
    free(bytes);
    rmse = picture_error(from, fit, &mean);
    cli_say("%zu primitives, %zu bytes for %zu: a %.0fth of the size", r->primitives, size, source,
            (double)source / (double)size);
    cli_say(
        "density: RMSE %.4f of the mean inside, overlap of the solid part %.4f (%d x %d x %d cells of %g m)",
        r->error, r->overlap, r->cells[0], r->cells[1], r->cells[2], r->cell);
    cli_say("pictures from six sides: RMSE %.4f of linear radiance, whose mean is %.4f", rmse, mean);
    if (!r->reached)
        cli_say("the error asked for, %g, is not reached (%s)", cli_vdb_fit_values.error,
                r->primitives < fit_options().primitives
                    ? "no more primitives help; --cells shows finer parts"
                    : "--primitives allows more");
}

/* For the cloud's provenance. */
static void note_file(const char *path)
{
    shape_error error;
    unsigned char *bytes;
    size_t size;
    cli_check(shape_file_read(path, (size_t)cli_volume_values.max_memory, &bytes, &size, &error), &error);
    cli_note_input(path, bytes, size);
    free(bytes);
}

void cli_vdb_fit(const cli_common *common, const char *path, const unsigned char *bytes, size_t size)
{
    shape_error error;
    shape_volume *volume;
    shape_volumefit_report r;
    size_t cloud;
    char name[SHAPE_NAME_MAX + 1];
    shape_volumefit_options options = fit_options();
    shape_set *from = bytes ? cli_read_volume_bytes("standard input", bytes, size) : cli_read_volume(path);
    shape_set *fit = shape_set_create(&error);
    if (!fit)
        cli_fail("%s", error.text);
    cli_check(shape_volume_create(from, &volume, &error), &error);
    cli_bare_name(path, "volume", name);
    if (shape_volumefit(volume, &options, fit, name, &cloud, &r, &error))
        cli_fail("%s: %s", path, error.text);
    shape_volume_destroy(volume);
    cli_progress("fitting", 1);
    if (bytes)
        cli_note_input(path, bytes, size);
    else
        note_file(path);
    cli_made_by(fit->clouds[cloud].made_by);
    fit->clouds[cloud].seed = fit->clouds[cloud].field.seed = common->seed;
    cli_write_set(common, fit);
    report(common, bytes ? size : file_size(path), from, fit, &r);
    shape_set_destroy(from);
    shape_set_destroy(fit);
}
