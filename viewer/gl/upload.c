/* A volume as textures. A primitive chunk of a .neph is uploaded as it stands: spheres are texels, ellipsoids three.
 * A cloud's record is shape/record.h's; besides, texels
 *   18      baked density: its place in the atlas [voxels], voxels a metre of the cloud's frame
 *   19      baked density: low corner of its box
 *   20      voxel grid: its place in the atlas of values [voxels] (exact view)
 *   21      voxel grid: points along x, y, z
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gl_private.h"
#include "shape/record.h"

GLuint gl_float_texture(const float *data, size_t texels, shape_status *status, shape_error *error)
{
    enum { WIDTH = 2048 };
    GLint largest = 2048;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    size_t rows = 1;
    while (rows * WIDTH < texels) /* a power of two: Mesa compiles shaders anew where that changes */
        rows *= 2;
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

/* A volume of voxels alone has no noise; its shaders are given a cell of nothing, which they never ask for. */
void gl_scene_load_noise(gl_scene *scene, const shape_noise *noise)
{
    if (scene->noise_cells)
        return;
    static const uint16_t nothing[8];
    const uint16_t *cells = noise ? noise->cells : nothing;
    const int side = noise ? SHAPE_NOISE_SIZE : 1;
    const size_t count = (size_t)side * (size_t)side * (size_t)side;
    glGenTextures(1, &scene->noise_cells);
    glBindTexture(GL_TEXTURE_3D, scene->noise_cells);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGBA32UI, side, side, side, 0, GL_RGBA_INTEGER, GL_UNSIGNED_INT, cells);
    /* The plain lattice, filtered by the hardware: the paper's way. */
    float *plain = malloc(sizeof(float) * count);
    if (!plain)
        return;
    for (size_t i = 0; i < count; i++)
        plain[i] = (float)cells[8 * i] * (1.0f / 65535.0f);
    glGenTextures(1, &scene->noise_linear);
    glBindTexture(GL_TEXTURE_3D, scene->noise_linear);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_R32F, side, side, side, 0, GL_RED, GL_FLOAT, plain);
    free(plain);
}

/* The lists of all clouds' supports, then those of their shapes; mostly the same. */
static const shape_primitives *list_number(const shape_volume *volume, size_t i)
{
    size_t count = volume->cloud_count;
    return i < count ? volume->clouds[i].list : volume->clouds[i - count].shape_list;
}

/* The first number of the same list as number i, by a hash table of lists with open addressing. */
static size_t first_of(const shape_volume *volume, size_t *slots, size_t mask, size_t i)
{
    const shape_primitives *list = list_number(volume, i);
    size_t slot = (size_t)(((uintptr_t)list >> 4) * 0x9e3779b97f4a7c15u >> 20) & mask;
    while (slots[slot] && list_number(volume, slots[slot] - 1) != list)
        slot = (slot + 1) & mask;
    if (!slots[slot])
        slots[slot] = i + 1;
    return slots[slot] - 1;
}

/* Where each list begins in the textures of all lists; copies share. */
static shape_status place_lists(gl_scene *scene, const shape_volume *volume, bool ellipsoids, size_t *total,
                                shape_error *error)
{
    size_t *places = ellipsoids ? scene->list_ellipsoids : scene->list_spheres, count = 16;
    while (count < 4 * volume->cloud_count)
        count *= 2;
    size_t *slots = calloc(count, sizeof *slots);
    if (!slots)
        return shape_error_memory(error);
    *total = 0;
    for (size_t i = 0; i < 2 * volume->cloud_count; i++) {
        const shape_primitives *list = list_number(volume, i);
        size_t first = first_of(volume, slots, count - 1, i);
        places[i] = first < i ? places[first] : *total;
        if (first == i)
            *total += ellipsoids ? list->ellipsoid_count : list->sphere_count;
    }
    free(slots);
    return SHAPE_OK;
}

static shape_status upload_lists(gl_scene *scene, const shape_volume *volume, bool ellipsoids,
                                 shape_error *error)
{
    size_t total = 0;
    shape_status status = place_lists(scene, volume, ellipsoids, &total, error);
    if (status)
        return status;
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

/* All of a record that does not depend on the eye or the light; roots: the first node of each tree. */
static void fill_record(const gl_scene *scene, const shape_volume *volume, size_t i, const size_t *roots,
                        float *record)
{
    const shape_volume_cloud *c = &volume->clouds[i];
    size_t shapes = volume->cloud_count + i;
    shape_record_places places = {.spheres = scene->list_spheres[i],
                                  .ellipsoids = scene->list_ellipsoids[i],
                                  .nodes = roots[c->tree_index]};
    if (c->detailed) {
        places.shape_spheres = scene->list_spheres[shapes];
        places.shape_ellipsoids = scene->list_ellipsoids[shapes];
        places.shape_nodes = roots[c->detail_tree_index];
    }
    shape_record_fill((float(*)[4])record, c, &places);
    put(record + 36, 1, 1, 1, c->medium.droplet); /* a light grid of one cell, until there is light */
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
    size_t *roots = calloc(volume->tree_count + 1, sizeof *roots);
    if (!roots)
        return shape_error_memory(error);
    for (size_t i = 1; i < volume->tree_count; i++)
        roots[i] = roots[i - 1] + volume->trees[i - 1].count;
    for (size_t i = 0; i < count; i++)
        fill_record(scene, volume, i, roots, scene->records + i * record_floats);
    free(roots);
    glGenTextures(1, &scene->clouds);
    glBindTexture(GL_TEXTURE_2D, scene->clouds);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, GL_RECORD_TEXELS, (GLsizei)count + 1, 0, GL_RGBA, GL_FLOAT,
                 NULL);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return SHAPE_OK;
}

/* Whether the ball around a cloud's box lies outside one side for certain: most clouds of a large sky do. */
static bool is_far_off(const shape_volume_cloud *c, const shape_camera *camera, double width, double height,
                       double wider)
{
    shape_dvec3 middle = {0}, half = {0};
    double radius2 = 0;
    for (int i = 0; i < 3; i++) {
        const double low = (double)(&c->box.min.x)[i], high = (double)(&c->box.max.x)[i];
        (&middle.x)[i] = 0.5 * (low + high);
        (&half.x)[i] = 0.5 * (high - low);
    }
    for (int i = 0; i < 3; i++) { /* so far away are the corners at most along each axis */
        const double *m = c->frame.m[i],
                     reach = fabs(m[0] * half.x) + fabs(m[1] * half.y) + fabs(m[2] * half.z);
        radius2 += reach * reach;
    }
    shape_dvec3 p = shape_dvec3_sub(shape_frame_point(&c->frame, middle), camera->origin);
    const double radius = sqrt(radius2) + 1e-6 * (fabs(p.x) + fabs(p.y) + fabs(p.z));
    const double x = fabs(shape_dvec3_dot(p, camera->right)) / width,
                 y = fabs(shape_dvec3_dot(p, camera->up)) / height, z = shape_dvec3_dot(p, camera->forward);
    width *= wider;
    height *= wider;
    return z + radius < 0 || x - z * width > radius * sqrt(1 + width * width) ||
           y - z * height > radius * sqrt(1 + height * height);
}

bool gl_in_sight(const shape_volume_cloud *c, const shape_camera *camera, double wider)
{
    int outside[5] = {0};
    double width = shape_dvec3_length(camera->right), height = shape_dvec3_length(camera->up);
    if (is_far_off(c, camera, width, height, wider))
        return false;
    for (int corner = 0; corner < 8; corner++) {
        shape_dvec3 p = {corner & 1 ? c->box.max.x : c->box.min.x, corner & 2 ? c->box.max.y : c->box.min.y,
                         corner & 4 ? c->box.max.z : c->box.min.z};
        p = shape_dvec3_sub(shape_frame_point(&c->frame, p), camera->origin);
        double x = shape_dvec3_dot(p, camera->right) / width, y = shape_dvec3_dot(p, camera->up) / height;
        double z = shape_dvec3_dot(p, camera->forward);
        outside[0] += x > z * width * wider;
        outside[1] += -x > z * width * wider;
        outside[2] += y > z * height * wider;
        outside[3] += -y > z * height * wider;
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
        if (!c->tree->count || !gl_in_sight(c, camera, 1))
            continue;
        float *record = rows + (size_t)count * record_floats;
        scene->shown[count++] = i;
        memcpy(record, scene->records + (size_t)i * record_floats, record_floats * sizeof *record);
        shape_record_set_eye((float(*)[4])record, c, camera->origin);
    }
    scene->shown_count = count;
    gl_settle();
    glBindTexture(GL_TEXTURE_2D, scene->clouds);
    if (count)
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, GL_RECORD_TEXELS, count, GL_RGBA, GL_FLOAT, rows);
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
