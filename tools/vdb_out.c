/* neph-vdb, outwards: the grids that were asked for, their notes, and the file. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_picture.h"
#include "shape/lightvoxels.h"
#include "vdb.h"

/* The grids of --grids, in the order in which they are written behind the density. */
static const struct kind {
    const char *name;
    shape_voxel_quantity quantity;
} kinds[] = {{"density", SHAPE_VOXEL_DENSITY},
             {"light", SHAPE_VOXEL_SAMPLE},
             {"sdf", SHAPE_VOXEL_SDF},
             {"profile", SHAPE_VOXEL_PROFILE},
             {"detail_type", SHAPE_VOXEL_DETAIL_TYPE},
             {"density_scale", SHAPE_VOXEL_DENSITY_SCALE}};
enum { KINDS = sizeof kinds / sizeof *kinds };

/* All grids of a file: kinds times clouds, or kinds alone. */
typedef struct plan {
    bool wanted[KINDS];
    size_t count;
    shape_voxel_request *requests;
    int *kind;
} plan;

static void read_grids(plan *p)
{
    p->wanted[0] = true;
    const char *text = vdb.grids;
    while (text && *text) {
        size_t length = strcspn(text, ",");
        int found = -1;
        for (int i = 1; i < KINDS; i++)
            if (strlen(kinds[i].name) == length && !strncmp(kinds[i].name, text, length))
                found = i;
        if (found < 0 || (text[length] == ',' && !text[length + 1]))
            cli_wrong("--grids \"%s\": expected light, sdf, profile, detail_type, density_scale, separated "
                      "by commas",
                      vdb.grids);
        p->wanted[found] = true;
        text += length + (text[length] == ',');
    }
    if (vdb.grids && !*vdb.grids)
        cli_wrong("--grids: names no grid (leave it out)");
    const cli_picture *light = &cli_picture_values;
    if (!p->wanted[1] &&
        (vdb.light_resolution_given || light->sun_given || light->sky_given || light->sun_irradiance_given))
        cli_wrong(
            "--sun, --sun-irradiance, --sky, --light-resolution: have no meaning without --grids light");
}

static void make_requests(plan *p, const shape_set *set)
{
    size_t each = vdb.each ? set->cloud_count : 1;
    p->requests = calloc(KINDS * (each + 1), sizeof *p->requests);
    p->kind = calloc(KINDS * (each + 1), sizeof *p->kind);
    if (!p->requests || !p->kind)
        cli_fail("out of memory");
    for (size_t c = 0; c < each; c++) {
        if (vdb.each && !shape_primitives_count(shape_set_list_const(set, c))) {
            cli_say("cloud \"%s\" is empty and gets no grid", set->clouds[c].name);
            continue;
        }
        for (int i = 0; i < KINDS; i++) {
            if (!p->wanted[i])
                continue;
            shape_voxel_request r = shape_voxel_request_defaults();
            r.quantity = kinds[i].quantity;
            r.cloud = vdb.each ? (int)c : -1;
            r.ramp = i == 0 && vdb.ramp_given ? vdb.ramp : 0;
            p->kind[p->count] = i;
            p->requests[p->count++] = r;
        }
    }
}

/* The cloud whose medium a grid of density is weighed by: the one with the greatest extinction. */
static const shape_cloud *leading_cloud(const shape_set *set, int only)
{
    size_t best = only < 0 ? 0 : (size_t)only;
    for (size_t i = 0; i < set->cloud_count && only < 0; i++)
        if (set->clouds[i].medium.extinction > set->clouds[best].medium.extinction)
            best = i;
    return &set->clouds[best];
}

static void note(shape_vdb *file, shape_vdb_grid *grid, const char *name, const char *text)
{
    shape_error error;
    cli_check(shape_vdb_note(file, grid, name, text, &error), &error);
}

static void note_number(shape_vdb *file, shape_vdb_grid *grid, const char *name, double value)
{
    shape_error error;
    cli_check(shape_vdb_note_number(file, grid, name, (float)value, &error), &error);
}

static void note_medium(shape_vdb *file, shape_vdb_grid *grid, const shape_cloud *cloud)
{
    static const char *const models[] = {"uniform", "spheroid", "metaball", "layer", "grid"};
    static const char *const phases[] = {"hg", "isotropic", "rayleigh", "mie", "two-lobe"};
    const shape_medium *m = &cloud->medium;
    note_number(file, grid, "neph_extinction", vdb.values ? 1 : (double)m->extinction);
    note_number(file, grid, "neph_albedo", (double)m->albedo);
    note(file, grid, "neph_phase", phases[m->phase]);
    note_number(file, grid, "neph_g", (double)m->g);
    note_number(file, grid, "neph_g2", (double)m->g2);
    note_number(file, grid, "neph_lobe_mix", (double)m->lobe_mix);
    note_number(file, grid, "neph_droplet", (double)m->droplet);
    note(file, grid, "neph_model", models[cloud->field.model]);
}

/* Where each cloud of a grid comes from. */
static void note_origin(shape_vdb *file, shape_vdb_grid *grid, const shape_set *set, int only)
{
    enum { NOTED = 64 }; /* clouds; a thousand copies say the same */
    int number = 0;
    for (size_t i = 0; i < set->cloud_count && number < NOTED; i++) {
        if (only >= 0 && i != (size_t)only)
            continue;
        char name[40], text[SHAPE_NAME_MAX + SHAPE_MADE_BY_MAX + 8];
        snprintf(name, sizeof name, "neph_cloud_%d", ++number);
        snprintf(text, sizeof text, "%s: %s", set->clouds[i].name, set->clouds[i].made_by);
        note(file, grid, name, text);
    }
}

static shape_vdb_grid *add_grid(shape_vdb *file, const shape_set *set, const shape_voxel_lattice *lattice,
                                const shape_voxel_request *r, int kind)
{
    shape_error error;
    shape_vdb_grid *grid;
    char name[SHAPE_NAME_MAX + 32];
    snprintf(name, sizeof name, "%s%s%s", kinds[kind].name, r->cloud < 0 ? "" : "_",
             r->cloud < 0 ? "" : set->clouds[r->cloud].name);
    shape_vdb_options options = {.name = name,
                                 .edge = lattice->edge,
                                 .origin = {lattice->origin[0], lattice->origin[1], lattice->origin[2]},
                                 .vector = r->quantity == SHAPE_VOXEL_SAMPLE,
                                 .level_set = r->quantity == SHAPE_VOXEL_SDF,
                                 .background = (float)(r->band * lattice->edge),
                                 .half = vdb.half};
    cli_check(shape_vdb_add(file, &options, &grid, &error), &error);
    note(file, grid, "neph_up", vdb.up ? "y" : "z");
    if (kind == 0) {
        note_medium(file, grid, leading_cloud(set, r->cloud));
        note_origin(file, grid, set, r->cloud);
    }
    return grid;
}

static void say_grid(const char *name, shape_vdb_grid *grid)
{
    shape_error error;
    shape_vdb_summary s;
    cli_check(shape_vdb_summarise(grid, &s, &error), &error);
    if (s.active) /* else encoding says so */
        cli_say("%s: %llu voxels filled, %zu leaves, %.1f MB", name, (unsigned long long)s.active, s.leaves,
                1e-6 * (double)s.bytes);
}

static shape_lightvoxels make_light(const shape_set *set, const shape_volume *volume)
{
    shape_error error;
    shape_view view;
    shape_light light;
    shape_lightvoxels made;
    cli_picture_apply(set, &view, &light);
    cli_check(shape_lightvoxels_build(volume, &light, (int)vdb.light_resolution, 0, &made, &error), &error);
    return made;
}

static void write_grids(const cli_common *common, const shape_set *set, const shape_volume *volume,
                        const shape_voxel_lattice *lattice, plan *p, vdb_format format)
{
    shape_error error;
    shape_lightvoxels light = {0};
    unsigned char *bytes;
    size_t size;
    char made_by[SHAPE_MADE_BY_MAX + 1];
    shape_vdb *file = shape_vdb_create();
    if (!file)
        cli_fail("out of memory");
    if (p->wanted[1])
        light = make_light(set, volume);
    cli_made_by(made_by);
    note(file, NULL, "creator", made_by);
    for (size_t i = 0; i < p->count; i++) {
        shape_voxel_request r = p->requests[i];
        r.sample = shape_lightvoxels_sample;
        r.sample_context = &light;
        if (vdb.values)
            r.scale = (double)leading_cloud(set, r.cloud)->medium.extinction;
        shape_vdb_grid *grid = add_grid(file, set, lattice, &r, p->kind[i]);
        shape_voxel_sink sink = {grid, shape_vdb_put_brick, shape_vdb_put_tile};
        cli_check(shape_voxels_fill(volume, lattice, &r, &sink, &error), &error);
        say_grid(kinds[p->kind[i]].name, grid);
        cli_progress("filling", (double)(i + 1) / (double)p->count);
    }
    cli_check(shape_vdb_encode(file, format == VDB_FORMAT_NVDB ? SHAPE_VDB_NANOVDB : SHAPE_VDB_OPENVDB,
                               &bytes, &size, &error),
              &error);
    shape_vdb_destroy(file);
    cli_write(common, bytes, size, true);
    free(bytes);
    if (p->wanted[1])
        shape_lightvoxels_free(&light);
}

void vdb_write_volume(const cli_common *common, const shape_set *set, vdb_format format)
{
    shape_error error;
    shape_volume *volume;
    plan p = {0};
    read_grids(&p);
    /* The error and the light look at single points and rays. */
    bool bare = !vdb.error_given && !p.wanted[1];
    cli_check(bare ? shape_volume_create_bare(set, &volume, &error)
                   : shape_volume_create(set, &volume, &error),
              &error);
    make_requests(&p, set);
    shape_voxel_lattice lattice = vdb_choose_lattice(common, set, volume, p.requests, p.count, format);
    if (format == VDB_FORMAT_RAW) {
        if (vdb.values)
            p.requests[0].scale = (double)leading_cloud(set, -1)->medium.extinction;
        vdb_write_raw(common, set, volume, &lattice, &p.requests[0]);
    } else {
        write_grids(common, set, volume, &lattice, &p, format);
    }
    free(p.requests);
    free(p.kind);
    shape_volume_destroy(volume);
}
