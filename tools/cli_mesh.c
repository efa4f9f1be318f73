/* The cloud of neph-mesh: reading, decimating, fitting and filling a mesh. */
#include "cli_mesh.h"

#include <stdlib.h>
#include <string.h>

#include "mesh_file.h"
#include "shape/meshfit.h"

enum { MEASURE_SAMPLES = 20000 };

static const cli_mesh_values *const options = &cli_mesh_options;

/* From the file's axes and unit to y up and metres, scaled to --size. */
static void turn_and_scale(shape_mesh *mesh, shape_mesh_format format)
{
    bool z_up = mesh_file_z_up(format);
    if (options->up_given)
        z_up = options->up == 1;
    double s = options->unit;
    shape_dvec3 min, max;
    if (options->size_given && shape_mesh_bounds(mesh, &min, &max)) {
        shape_dvec3 side = shape_dvec3_sub(max, min);
        s = options->size / fmax(side.x, fmax(side.y, side.z));
    }
    shape_frame frame = {{{s, 0, 0, 0}, {0, s, 0, 0}, {0, 0, s, 0}}};
    if (z_up) {
        shape_frame turned = {{{s, 0, 0, 0}, {0, 0, s, 0}, {0, -s, 0, 0}}};
        frame = turned;
    }
    shape_mesh_transform(mesh, &frame);
}

/* Primitives are kept in single precision, so a mesh that is far away for its size is brought to the origin and the
 * cloud's frame takes the way. Within 64 diagonals nothing is moved: rounding stays below 4e-6 of the diagonal. */
static shape_dvec3 bring_near(shape_mesh *mesh)
{
    shape_dvec3 min = {0, 0, 0}, max = min, none = min;
    shape_mesh_bounds(mesh, &min, &max);
    shape_dvec3 middle = shape_dvec3_scale(shape_dvec3_add(min, max), 0.5);
    bool far = shape_dvec3_length(middle) > 64 * shape_dvec3_length(shape_dvec3_sub(max, min));
    if (!options->center && !far)
        return none;
    shape_frame frame = shape_frame_identity();
    frame.m[0][3] = -middle.x;
    frame.m[1][3] = -middle.y;
    frame.m[2][3] = -middle.z;
    shape_mesh_transform(mesh, &frame);
    return options->center ? none : middle;
}

static void say_read(const char *path, shape_mesh_format format, const shape_mesh *mesh)
{
    const shape_mesh_counts *counts = &mesh->counts;
    cli_say("%s: %s, %zu faces, %zu triangles", strcmp(path, "-") ? path : "standard input",
            shape_mesh_format_name(format), counts->faces, counts->triangles);
    if (counts->instances > 1)
        cli_say("%zu nodes place meshes", counts->instances);
    if (counts->skinned || counts->animated)
        cli_say("the file is %s: its rest pose is taken", counts->skinned && counts->animated
                                                              ? "skinned and animated"
                                                          : counts->skinned ? "skinned"
                                                                            : "animated");
    if (counts->skipped)
        cli_say("skipped: %zu points, lines or faces with fewer than three corners", counts->skipped);
    cli_say("repaired: %zu duplicate vertices merged, %zu zero-area and %zu duplicate faces dropped; %zu "
            "triangles left",
            counts->duplicate_points, counts->zero_area, counts->duplicate_faces, mesh->triangle_count);
}

static void decimate(shape_mesh *mesh)
{
    shape_error error;
    size_t before = mesh->triangle_count, target = (size_t)options->faces;
    if (!target || before <= target) {
        cli_say("decimated: no, %zu triangles are few enough", before);
        return;
    }
    cli_check(shape_mesh_decimate(mesh, target, &error), &error);
    if (mesh->counts.non_manifold)
        cli_say("repaired: %zu faces cut loose where an edge has more than two", mesh->counts.non_manifold);
    cli_say("decimated: %zu triangles to %zu%s", before, mesh->triangle_count,
            mesh->triangle_count > target ? " (its separate parts cannot be reduced further)" : "");
}

static shape_mesh *copy_mesh(const shape_mesh *mesh)
{
    shape_error error;
    shape_mesh *copy = shape_mesh_create(mesh->point_count, mesh->triangle_count, &error);
    if (!copy)
        cli_fail("%s", error.text);
    memcpy(copy->points, mesh->points, mesh->point_count * sizeof *mesh->points);
    memcpy(copy->indices, mesh->indices, 3 * mesh->triangle_count * sizeof *mesh->indices);
    copy->point_count = mesh->point_count;
    copy->triangle_count = mesh->triangle_count;
    return copy;
}

static size_t fill(const shape_mesh *mesh, shape_primitives *list)
{
    shape_error error;
    size_t made = 0, open = 0;
    if (!options->fill)
        return 0;
    cli_check(shape_mesh_open_edges(mesh, &open, &error), &error);
    cli_check(shape_mesh_fill(mesh, (size_t)options->fill, (int)options->voxels, list, &made, &error),
              &error);
    if (!made)
        cli_say("filled: no, the mesh has no inside%s",
                open ? " (it is open: close its holes)"
                     : " (nothing is thicker than two voxels: try more --voxels)");
    return made;
}

static void measure(const shape_mesh *mesh, const shape_primitives *list)
{
    shape_error error;
    shape_meshfit_measure result;
    cli_check(shape_meshfit_compare(mesh, list, MEASURE_SAMPLES, &result, &error), &error);
    cli_say("covered: %.2f %% of the mesh's surface; sticking out, in %% of its diagonal: mean %.3f, 95 of "
            "100 below "
            "%.3f, at most %.3f",
            100 * result.covered, 100 * result.mean_sticking, 100 * result.p95_sticking,
            100 * result.max_sticking);
}

static void check_options(void)
{
    if (options->fit && options->no_rotate)
        cli_wrong("--fit --no-rotate: a fit in the triangle's plane is turned (give one of them)");
    if (options->thickness_given && !options->fit)
        cli_wrong("--thickness: has no meaning without --fit");
    if (options->voxels_given && !options->fill_given)
        cli_wrong("--voxels: has no meaning without --fill");
    if (options->size_given && options->unit_given)
        cli_wrong("--size --unit: both set the scale (give one of them)");
}

static void make_cloud(shape_set *set, const char *input, uint64_t seed, shape_mesh *mesh, shape_dvec3 offset)
{
    shape_error error;
    size_t index;
    char name[SHAPE_NAME_MAX + 1];
    shape_meshfit fit = shape_meshfit_defaults();
    fit.kind = options->fit         ? SHAPE_MESHFIT_PLANE
               : options->no_rotate ? SHAPE_MESHFIT_UPRIGHT
                                    : SHAPE_MESHFIT_PAPER;
    fit.scale = options->scale;
    fit.thickness = options->thickness;
    cli_bare_name(input, "mesh", name);
    cli_check(shape_set_add_cloud(set, name, &index, &error), &error);
    shape_cloud *cloud = &set->clouds[index];
    shape_primitives *list = shape_set_list(set, index);
    shape_mesh *whole = options->fill || options->measure ? copy_mesh(mesh) : NULL;
    decimate(mesh);
    cli_check(shape_meshfit_add(mesh, &fit, list, &error), &error);
    if (options->measure) /* the shell alone: spheres within are not meant to lie on the surface */
        measure(whole, list);
    size_t spheres = options->fill ? fill(whole, list) : 0;
    shape_mesh_destroy(whole);
    cloud->seed = cloud->field.seed = seed;
    cloud->frame.m[0][3] = offset.x;
    cloud->frame.m[1][3] = offset.y;
    cloud->frame.m[2][3] = offset.z;
    cli_made_by(cloud->made_by);
    cli_medium_apply(cloud);
    cli_check(shape_cloud_choose_noise_scale(cloud, list, &error), &error);
    if (spheres)
        cli_say("%zu ellipsoids, %zu spheres inside", list->ellipsoid_count, spheres);
    else
        cli_say("%zu ellipsoids", list->ellipsoid_count);
}

shape_set *cli_mesh_make(const char *input, uint64_t seed)
{
    shape_error error;
    shape_mesh_format format;
    check_options();
    shape_mesh *mesh = mesh_file_read(input, true, &format);
    shape_status status = shape_mesh_repair(mesh, &error);
    if (status)
        cli_fail("%s: %s", input, error.text);
    say_read(input, format, mesh);
    turn_and_scale(mesh, format);
    shape_dvec3 offset = bring_near(mesh);
    shape_set *set = shape_set_create(&error);
    if (!set)
        cli_fail("%s", error.text);
    make_cloud(set, input, seed, mesh, offset);
    shape_mesh_destroy(mesh);
    return set;
}
