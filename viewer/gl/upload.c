/* A volume as textures. A primitive chunk of a .neph is uploaded as it stands: spheres are texels, ellipsoids three.
 *
 * A cloud's record, GL_RECORD_TEXELS texels:
 *   0..2    rows of the world-to-cloud matrix; w: the eye in the cloud's frame
 *   3, 4    box, low with the extinction (of a grid: that of its largest value), high with the number of its tree's first node
 *   5       kappa, octaves, 1 / noise scale, model
 *   6       first sphere, first ellipsoid, nodes of the tree, support
 *   7       edge, spheres, ellipsoids, metres of the world a noise cell
 *   8       light grid: its place in the atlas [cells]
 *   9       light grid: cells along x, y, z; droplet diameter
 *   10, 11  light grid: box
 *   12..15  noise offsets of 16 octaves, x + 64 y + 4096 z
 *   16      albedo, phase function, g, g2
 *   17      lobe mix, mean cosine, share in the phase function's peak, g of the rest
 *   18      baked density: its place in the atlas [voxels], voxels a metre of the cloud's frame
 *   19      baked density: low corner of its box
 *   20      voxel grid: its place in the atlas of values [voxels] (exact view)
 *   21      voxel grid: points along x, y, z
 *   22, 23  not used
 *   24      whether the cloud has details or is a layer (else the rest is 0), first sphere and ellipsoid of its shapes,
 *           nodes of the shapes' tree
 *   25      the first of them, smoothness, displace, 1 / displace_scale
 *   26      billow, wisp, 1 / detail_depth, 1 / detail_scale
 *   27      base, 1 / height
 *   28, 29  keys of the noises, in halves of 16 bits, the low one first
 *   30      layer: bounds, noise, blend, gain
 *   31      layer: Worley's gain, frequency and octaves; planet's radius
 *   32      layer: A, B, coverage, cut
 *   33      layer: falloff, fades at the bottom, the top, the sides
 *   34      layer: 1 / cell along x, y, z
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/phase.h"

GLuint gl_float_texture(const float *data, size_t texels, shape_status *status, shape_error *error)
{
    enum { WIDTH = 2048 };
    GLint largest = 2048;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    size_t rows = texels ? (texels + WIDTH - 1) / WIDTH : 1;
    if (rows > (size_t)largest) {
        *status = shape_error_set(error, SHAPE_ERROR_LIMIT,
                                  "%zu texels are more than this GPU's textures hold (%zu)", texels,
                                  (size_t)largest * WIDTH);
        return 0;
    }
    GLuint texture;
    glGenTextures(1, &texture);
    glBindTexture(GL_TEXTURE_2D, texture);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, WIDTH, (GLsizei)rows, 0, GL_RGBA, GL_FLOAT, NULL);
    size_t whole = texels / WIDTH, rest = texels % WIDTH;
    if (whole)
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, WIDTH, (GLsizei)whole, GL_RGBA, GL_FLOAT, data);
    if (rest)
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, (GLint)whole, (GLsizei)rest, 1, GL_RGBA, GL_FLOAT,
                        data + whole * WIDTH * 4);
    return texture;
}

static void upload_noise(gl_scene *scene, const shape_noise *noise)
{
    enum { N = SHAPE_NOISE_SIZE };
    glGenTextures(1, &scene->noise_cells);
    glBindTexture(GL_TEXTURE_3D, scene->noise_cells);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA32UI, N, N, N, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, noise->cells);
    /* The plain lattice, filtered by the hardware: the paper's way. */
    float *plain = malloc(sizeof(float) * N * N * N);
    if (!plain)
        return;
    for (size_t i = 0; i < (size_t)N * N * N; i++)
        plain[i] = (float)noise->cells[8 * i] * (1.0f / 65535.0f);
    glGenTextures(1, &scene->noise_linear);
    glBindTexture(GL_TEXTURE_3D, scene->noise_linear);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R32F, N, N, N, 0, GL_RED, GL_FLOAT, plain);
    free(plain);
}

/* The lists of all clouds' supports, then those of their shapes; mostly the same. */
static const shape_primitives *list_number(const shape_volume *volume, size_t i)
{
    size_t count = volume->cloud_count;
    return i < count ? volume->clouds[i].list : volume->clouds[i - count].shape_list;
}

/* Where each list begins in the textures of all lists; copies share. */
static size_t place_lists(gl_scene *scene, const shape_volume *volume, bool ellipsoids)
{
    size_t total = 0, *places = ellipsoids ? scene->list_ellipsoids : scene->list_spheres;
    for (size_t i = 0; i < 2 * volume->cloud_count; i++) {
        const shape_primitives *list = list_number(volume, i);
        size_t j = i < volume->cloud_count ? 0 : i - volume->cloud_count; /* its own supports, most likely */
        while (j < i && list_number(volume, j) != list)
            j++;
        places[i] = j < i ? places[j] : total;
        if (j == i)
            total += ellipsoids ? list->ellipsoid_count : list->sphere_count;
    }
    return total;
}

static shape_status upload_lists(gl_scene *scene, const shape_volume *volume, bool ellipsoids,
                                 shape_error *error)
{
    size_t total = place_lists(scene, volume, ellipsoids);
    const size_t texels_each = ellipsoids ? 3 : 1;
    const size_t *places = ellipsoids ? scene->list_ellipsoids : scene->list_spheres;
    float *all = calloc((total * texels_each + 1) * 4, sizeof *all);
    if (!all)
        return shape_error_memory(error);
    for (size_t i = 0; i < 2 * volume->cloud_count; i++) {
        const shape_primitives *list = list_number(volume, i);
        size_t count = ellipsoids ? list->ellipsoid_count : list->sphere_count;
        const void *from = ellipsoids ? (const void *)list->ellipsoids : (const void *)list->spheres;
        if (count)
            memcpy(all + places[i] * texels_each * 4, from, count * texels_each * 16);
    }
    shape_status status = SHAPE_OK;
    GLuint texture = gl_float_texture(all, total * texels_each, &status, error);
    *(ellipsoids ? &scene->ellipsoids : &scene->spheres) = texture;
    free(all);
    return status;
}

static shape_status upload_trees(gl_scene *scene, const shape_volume *volume, shape_error *error)
{
    size_t total = 0;
    for (size_t i = 0; i < volume->tree_count; i++)
        total += volume->trees[i].count;
    shape_tree_node *all = calloc(total + 1, sizeof *all);
    if (!all)
        return shape_error_memory(error);
    total = 0;
    for (size_t i = 0; i < volume->tree_count; i++) {
        if (volume->trees[i].count)
            memcpy(all + total, volume->trees[i].nodes, volume->trees[i].count * sizeof *all);
        total += volume->trees[i].count;
    }
    shape_status status = SHAPE_OK;
    scene->nodes = gl_float_texture((const float *)all, total * 2, &status, error);
    free(all);
    return status;
}

static void put(float *texel, double x, double y, double z, double w)
{
    texel[0] = (float)x, texel[1] = (float)y, texel[2] = (float)z, texel[3] = (float)w;
}

/* What details and layers add to a record. */
static void fill_details(const gl_scene *scene, const shape_volume *volume, size_t i, size_t shape_root,
                         float *record)
{
    const shape_volume_cloud *c = &volume->clouds[i];
    const shape_detail *d = &c->field.detail;
    const shape_layer *l = &c->field.layer;
    size_t shapes = volume->cloud_count + i;
    put(record + 96, 1, (double)scene->list_spheres[shapes], (double)scene->list_ellipsoids[shapes],
        (double)c->detail_tree->count);
    put(record + 100, (double)shape_root, d->smoothness, d->displace, c->inverse_displace_scale);
    put(record + 104, d->billow, d->wisp, c->inverse_detail_depth, c->inverse_detail_scale);
    put(record + 108, c->base, c->inverse_height, 0, 0);
    for (int use = 0; use < 4; use++) {
        record[112 + 2 * use] = (float)(c->keys[use] & 0xffff);
        record[113 + 2 * use] = (float)(c->keys[use] >> 16);
    }
    put(record + 120, l->bounds, l->noise, l->blend, l->gain);
    put(record + 124, l->worley_gain, l->worley_frequency, l->worley_octaves, l->planet_radius);
    put(record + 128, l->ramp[0], l->ramp[1], l->coverage, l->cut);
    put(record + 132, l->falloff, l->fade_bottom, l->fade_top, l->fade_side);
    put(record + 136, c->inverse_cell.x, c->inverse_cell.y, c->inverse_cell.z, 0);
}

/* All of a record that does not depend on the eye or the light. */
static void fill_record(const gl_scene *scene, const shape_volume *volume, size_t i, size_t root,
                        float *record)
{
    const shape_volume_cloud *c = &volume->clouds[i];
    double scale = cbrt(fabs(shape_frame_determinant(&c->frame)));
    float share, rest, mean = shape_phase_mean_cosine(&c->medium);
    shape_delta_scaling(mean, &share, &rest);
    put(record + 12, c->box.min.x, c->box.min.y, c->box.min.z,
        (double)c->medium.extinction * (double)c->most); /* baked densities are in units of the largest */
    put(record + 16, c->box.max.x, c->box.max.y, c->box.max.z, (double)root);
    put(record + 20, c->field.kappa, c->field.octaves, c->inverse_noise_scale, c->field.model);
    put(record + 24, (double)scene->list_spheres[i], (double)scene->list_ellipsoids[i],
        (double)c->tree->count, c->support);
    put(record + 28, c->field.edge, (double)c->list->sphere_count, (double)c->list->ellipsoid_count,
        scale / (double)c->inverse_noise_scale);
    put(record + 36, 1, 1, 1, c->medium.droplet);
    for (int octave = 0; octave < SHAPE_OCTAVES_MAX; octave++) {
        const int *o = c->offsets[octave];
        record[48 + octave] = (float)(octave < c->field.octaves ? o[0] + 64 * o[1] + 4096 * o[2] : 0);
    }
    put(record + 64, c->medium.albedo, c->medium.phase, c->medium.g, c->medium.g2);
    put(record + 68, c->medium.lobe_mix, mean, share, rest);
}

shape_status gl_scene_load(gl_scene *scene, const shape_volume *volume, shape_error *error)
{
    gl_scene_free(scene);
    GLint largest = 2048;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (volume->cloud_count > (size_t)largest)
        return shape_error_set(error, SHAPE_ERROR_LIMIT,
                               "%zu clouds are more than this GPU can draw at once (%d)", volume->cloud_count,
                               (int)largest);
    size_t count = volume->cloud_count, record_floats = GL_RECORD_TEXELS * 4;
    scene->records = calloc(2 * (count + 1) * record_floats, sizeof *scene->records);
    scene->list_spheres = calloc(2 * count + 1, sizeof *scene->list_spheres);
    scene->list_ellipsoids = calloc(2 * count + 1, sizeof *scene->list_ellipsoids);
    scene->shown = calloc(count + 1, sizeof *scene->shown);
    if (!scene->records || !scene->list_spheres || !scene->list_ellipsoids || !scene->shown)
        return shape_error_memory(error);
    scene->cloud_count = (int)count;
    shape_status status = upload_lists(scene, volume, false, error);
    if (!status)
        status = upload_lists(scene, volume, true, error);
    if (!status)
        status = upload_trees(scene, volume, error);
    if (status)
        return status;
    upload_noise(scene, volume->noise);
    size_t *roots = calloc(volume->tree_count + 1, sizeof *roots);
    if (!roots)
        return shape_error_memory(error);
    for (size_t i = 1; i < volume->tree_count; i++)
        roots[i] = roots[i - 1] + volume->trees[i - 1].count;
    for (size_t i = 0; i < count; i++) {
        const shape_volume_cloud *c = &volume->clouds[i];
        float *record = scene->records + i * record_floats;
        fill_record(scene, volume, i, roots[c->tree_index], record);
        if (c->detailed)
            fill_details(scene, volume, i, roots[c->detail_tree_index], record);
    }
    free(roots);
    glGenTextures(1, &scene->clouds);
    glBindTexture(GL_TEXTURE_2D, scene->clouds);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return SHAPE_OK;
}

/* False where all corners of a cloud's box lie outside one side of the view's pyramid, or behind the eye. */
static bool in_sight(const shape_volume_cloud *c, const shape_camera *camera)
{
    int outside[5] = {0};
    double width = shape_dvec3_length(camera->right), height = shape_dvec3_length(camera->up);
    for (int corner = 0; corner < 8; corner++) {
        shape_dvec3 p = {corner & 1 ? c->box.max.x : c->box.min.x, corner & 2 ? c->box.max.y : c->box.min.y,
                         corner & 4 ? c->box.max.z : c->box.min.z};
        p = shape_dvec3_sub(shape_frame_point(&c->frame, p), camera->origin);
        double x = shape_dvec3_dot(p, camera->right) / width, y = shape_dvec3_dot(p, camera->up) / height;
        double z = shape_dvec3_dot(p, camera->forward);
        outside[0] += x > z * width;
        outside[1] += -x > z * width;
        outside[2] += y > z * height;
        outside[3] += -y > z * height;
        outside[4] += z < 0;
    }
    for (int side = 0; side < 5; side++)
        if (outside[side] == 8)
            return false;
    return true;
}

void gl_scene_place_eye(gl_scene *scene, const shape_volume *volume, const shape_camera *camera)
{
    size_t record_floats = GL_RECORD_TEXELS * 4;
    float *rows = scene->records + (size_t)(scene->cloud_count + 1) * record_floats;
    int count = 0;
    for (int i = 0; i < scene->cloud_count; i++) {
        const shape_volume_cloud *c = &volume->clouds[i];
        if (!c->tree->count || !in_sight(c, camera))
            continue;
        float *record = rows + (size_t)count * record_floats;
        scene->shown[count++] = i;
        memcpy(record, scene->records + (size_t)i * record_floats, record_floats * sizeof *record);
        shape_dvec3 eye = shape_frame_point(&c->inverse, camera->origin);
        put(record, c->inverse.m[0][0], c->inverse.m[0][1], c->inverse.m[0][2], eye.x);
        put(record + 4, c->inverse.m[1][0], c->inverse.m[1][1], c->inverse.m[1][2], eye.y);
        put(record + 8, c->inverse.m[2][0], c->inverse.m[2][1], c->inverse.m[2][2], eye.z);
    }
    scene->shown_count = count;
    glBindTexture(GL_TEXTURE_2D, scene->clouds);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, GL_RECORD_TEXELS, count ? count : 1, 0, GL_RGBA, GL_FLOAT,
                 rows);
}

void gl_scene_put(gl_scene *scene, int cloud, int texel, double x, double y, double z, double w)
{
    put(scene->records + ((size_t)cloud * GL_RECORD_TEXELS + (size_t)texel) * 4, x, y, z, w);
}

void gl_scene_free(gl_scene *scene)
{
    GLuint *textures[] = {&scene->clouds,      &scene->spheres,      &scene->ellipsoids, &scene->nodes,
                          &scene->noise_cells, &scene->noise_linear, &scene->grid_values};
    for (size_t i = 0; i < sizeof textures / sizeof *textures; i++)
        glDeleteTextures(1, textures[i]);
    free(scene->records);
    free(scene->list_spheres);
    free(scene->list_ellipsoids);
    free(scene->shown);
    memset(scene, 0, sizeof *scene);
}
