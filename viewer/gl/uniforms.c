/* What shaders are told: textures, camera, light. */
#include <math.h>
#include <string.h>

#include "gl_private.h"

void gl_bind(GLuint program, const char *name, int unit, GLenum kind, GLuint texture)
{
    glActiveTexture(GL_TEXTURE0 + (GLenum)unit);
    glBindTexture(kind, texture);
    glUniform1i(glGetUniformLocation(program, name), unit);
}

void gl_set_vector(GLuint program, const char *name, const float *v)
{
    glUniform3fv(glGetUniformLocation(program, name), 1, v);
}

void gl_set_dvector(GLuint program, const char *name, shape_dvec3 v)
{
    glUniform3f(glGetUniformLocation(program, name), (float)v.x, (float)v.y, (float)v.z);
}

void gl_set_float(GLuint program, const char *name, float v)
{
    glUniform1f(glGetUniformLocation(program, name), v);
}

void gl_set_int(GLuint program, const char *name, int v)
{
    glUniform1i(glGetUniformLocation(program, name), v);
}

void gl_set_scene(const gl_scene *scene, GLuint program)
{
    gl_bind(program, "clouds", 0, GL_TEXTURE_2D, scene->clouds);
    gl_bind(program, "spheres", 1, GL_TEXTURE_2D, scene->spheres);
    gl_bind(program, "ellipsoids", 2, GL_TEXTURE_2D, scene->ellipsoids);
    gl_bind(program, "nodes", 3, GL_TEXTURE_2D, scene->nodes);
    gl_bind(program, "noise_cells", 4, GL_TEXTURE_3D, scene->noise_cells);
    gl_set_int(program, "cloud_count", scene->shown_count);
    if (scene->cloud_count == 1) /* its record as it was uploaded last */
        glUniform4fv(glGetUniformLocation(program, "one_cloud"), GL_RECORD_TEXELS,
                     scene->records + (size_t)(scene->cloud_count + 1) * GL_RECORD_TEXELS * 4);
    gl_bind(program, "noise_linear", 5, GL_TEXTURE_3D, scene->noise_linear);
    gl_bind(program, "grid_values", 14, GL_TEXTURE_3D, scene->grid_values);
}

void gl_set_grids(const gl_grids *grids, GLuint program)
{
    gl_bind(program, "light_a", 6, GL_TEXTURE_3D, grids->light->a);
    gl_bind(program, "light_b", 7, GL_TEXTURE_3D, grids->light->b);
    gl_bind(program, "light_seen", 9, GL_TEXTURE_3D, grids->light->seen);
    gl_bind(program, "baked", 10, GL_TEXTURE_3D, grids->baked ? grids->baked->texture : 0);
}

void gl_set_light(const shape_gl_renderer *r, GLuint program)
{
    static const float up[3] = {0, 1, 0};
    float perez[15];
    memcpy(perez, r->sky.perez, sizeof perez);
    gl_set_int(program, "sky_kind", r->options.no_background ? SHAPE_SKY_NONE : r->sky.kind);
    gl_set_vector(program, "sky_constant", r->sky.constant);
    gl_set_vector(program, "sky_sun", r->sky.sun);
    glUniform1fv(glGetUniformLocation(program, "sky_perez"), 15, perez);
    gl_set_vector(program, "sky_zenith", r->sky.zenith);
    gl_set_vector(program, "sky_ground", r->sky.ground);
    gl_set_float(program, "sky_night", r->sky.night);
    gl_set_vector(program, "sky_upper", r->sky_upper);
    gl_set_vector(program, "sky_lower", r->sky_lower);
    gl_set_dvector(program, "sun_direction", r->light.sun);
    gl_set_vector(program, "sun_irradiance", r->light.sun_irradiance);
    gl_set_vector(program, "world_up", up);
}

void gl_set_camera(const gl_frame *frame, GLuint program)
{
    const shape_view *view = frame->view;
    const shape_camera *camera = frame->camera;
    int sample = frame->sample;
    gl_set_dvector(program, "camera_forward", camera->forward);
    gl_set_dvector(program, "camera_right", camera->right);
    gl_set_dvector(program, "camera_up", camera->up);
    glUniform2f(glGetUniformLocation(program, "picture_size"), (float)view->width, (float)view->height);
    glUniform2f(glGetUniformLocation(program, "picture_origin"), (float)frame->part->x,
                (float)frame->part->y);
    /* Roberts' R2 sequence, beginning at the pixel's centre. */
    double x = 0.5 + 0.7548776662466927 * sample, y = 0.5 + 0.5698402909980532 * sample;
    glUniform2f(glGetUniformLocation(program, "pixel_shift"), (float)(x - floor(x)), (float)(y - floor(y)));
    gl_set_int(program, "sample_number", sample);
}

void gl_set_tiles(const gl_tiles *tiles, GLuint program)
{
    gl_bind(program, "tiles", 11, GL_TEXTURE_2D, tiles->lists);
    gl_bind(program, "tile_list", 15, GL_TEXTURE_2D, tiles->order);
    gl_set_int(program, "tile_columns", tiles->columns);
    gl_bind(program, "tile_primitives", 16, GL_TEXTURE_2D, tiles->primitives);
    gl_set_int(program, "list_columns", tiles->list_columns);
    gl_set_float(program, "list_scale", tiles->list_scale);
}
