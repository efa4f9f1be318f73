/* engine CLOUD.neph [PICTURE.ppm]: what a game engine needs to draw a .neph: read it, upload it, draw it with Nephele's
 * shaders. Turns about the cloud until Esc; with PICTURE, draws one frame into that file. What is uploaded stands in
 * shaders/README.md. One draw call a cloud, farthest first, so that each has its textures for itself. */
#include "gl.h"

#include <math.h>

#include <shape/neph.h>
#include <shape/record.h>

enum { TEXTURES = 7 };
static const char *const texture_names[TEXTURES] = {"clouds",  "spheres", "ellipsoids", "nodes",
                                                    "light_a", "light_b", "noise_cells"};
typedef struct gpu_cloud {
    const shape_volume_cloud *cloud;
    shape_record record;
    GLuint textures[TEXTURES];
    double away; /* of its middle from the eye [m] */
} gpu_cloud;

/* Half of a light grid's eight values a cell. */
static GLuint light_texture(const shape_lightgrid *grid, int half)
{
    size_t cells = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    float *values = malloc(cells * 4 * sizeof *values);
    check(values ? SHAPE_OK : shape_error_memory(&error));
    for (size_t i = 0; i < 4 * cells; i++)
        values[i] = grid->cells[i / 4 * SHAPE_LIGHTGRID_VALUES + 4 * (size_t)half + i % 4];
    GLuint texture = volume_texture(grid->size, GL_RGBA32F, GL_RGBA, GL_FLOAT, GL_LINEAR, values);
    free(values);
    return texture;
}

/* A cloud's lists, tree and light. Where there are details, the lists and tree of its shapes follow those of its supports. */
static void upload(gpu_cloud *gpu, const shape_volume *volume, size_t i, const shape_light *light,
                   GLuint noise)
{
    const shape_volume_cloud *c = gpu->cloud = &volume->clouds[i];
    static const shape_primitives none;
    const shape_primitives *list = c->list, *more = c->detailed ? c->shape_list : &none;
    const shape_tree *tree = c->detailed ? c->detail_tree : NULL;
    shape_record_places places = {.shape_spheres = list->sphere_count,
                                  .shape_ellipsoids = list->ellipsoid_count,
                                  .shape_nodes = c->tree->count};
    shape_lightgrid_options options = shape_lightgrid_defaults();
    shape_lightgrid grid;
    check(shape_lightgrid_build(volume, i, light, &options, &grid, &error));
    shape_record_fill(gpu->record, c, &places);
    shape_record_set_light(gpu->record, c, &grid, NULL);
    gpu->textures[0] = float_texture(gpu->record, SHAPE_RECORD_TEXELS, NULL, 0);
    gpu->textures[1] = float_texture(list->spheres, list->sphere_count, more->spheres, more->sphere_count);
    gpu->textures[2] = float_texture(list->ellipsoids, 3 * list->ellipsoid_count, more->ellipsoids,
                                     3 * more->ellipsoid_count);
    gpu->textures[3] = float_texture(c->tree->nodes, 2 * c->tree->count, tree ? tree->nodes : NULL,
                                     tree ? 2 * tree->count : 0);
    gpu->textures[4] = light_texture(&grid, 0);
    gpu->textures[5] = light_texture(&grid, 1);
    gpu->textures[6] = noise;
    shape_lightgrid_free(&grid);
}

static void set3(GLuint program, const char *name, shape_dvec3 v)
{
    glUniform3f(glGetUniformLocation(program, name), (float)v.x, (float)v.y, (float)v.z);
}

static int farther(const void *a, const void *b)
{
    double x = ((const gpu_cloud *)a)->away, y = ((const gpu_cloud *)b)->away;
    return (x < y) - (x > y);
}

static void draw(GLuint program, gpu_cloud *clouds, size_t count, const shape_view *view)
{
    shape_camera camera = shape_view_camera(view);
    set3(program, "camera_forward", camera.forward);
    set3(program, "camera_right", camera.right);
    set3(program, "camera_up", camera.up);
    for (size_t i = 0; i < count; i++) {
        shape_box box = clouds[i].cloud->box;
        shape_dvec3 middle = {(box.min.x + box.max.x) / 2, (box.min.y + box.max.y) / 2,
                              (box.min.z + box.max.z) / 2};
        middle = shape_frame_point(&clouds[i].cloud->frame, middle);
        clouds[i].away = shape_dvec3_length(shape_dvec3_sub(middle, view->eye));
    }
    qsort(clouds, count, sizeof *clouds, farther);
    glClear(GL_COLOR_BUFFER_BIT);
    for (size_t i = 0; i < count; i++) {
        for (int j = TEXTURES - 1; j >= 0; j--) {
            glActiveTexture(GL_TEXTURE0 + (GLenum)j);
            glBindTexture(j < 4 ? GL_TEXTURE_2D : GL_TEXTURE_3D, clouds[i].textures[j]);
            glUniform1i(glGetUniformLocation(program, texture_names[j]), j);
        }
        shape_record_set_eye(clouds[i].record, clouds[i].cloud, view->eye);
        glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, SHAPE_RECORD_TEXELS, 1, GL_RGBA, GL_FLOAT, clouds[i].record);
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }
}

int main(int argc, char **argv)
{
    unsigned char *bytes;
    size_t size;
    shape_set *set;
    shape_volume *volume;
    if (argc < 2 || argc > 3)
        return fprintf(stderr, "usage: engine CLOUD.neph [PICTURE.ppm]\n"), 2;
    check(shape_file_read(argv[1], (size_t)1 << 30, &bytes, &size, &error));
    check(shape_neph_decode(bytes, size, &set, &error));
    check(shape_volume_create(set, &volume, &error));
    GLFWwindow *window = open_window(argc == 3);
    GLuint program = glCreateProgram(), array;
    attach(program, GL_VERTEX_SHADER, VERTEX_SHADER);
    attach(program, GL_FRAGMENT_SHADER, FRAGMENT_SHADER);
    glLinkProgram(program);
    glUseProgram(program);
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);

    shape_light light = shape_light_defaults();
    shape_sky sky = shape_sky_make(&light);
    float upper[3], lower[3];
    shape_sky_mean(&sky, upper, lower);
    set3(program, "sky_upper", shape_dvec3_make(upper[0], upper[1], upper[2]));
    set3(program, "sky_lower", shape_dvec3_make(lower[0], lower[1], lower[2]));
    set3(program, "sun_irradiance", shape_dvec3_make(3.14, 3.14, 3.14));
    set3(program, "sun_direction", light.sun);
    set3(program, "world_up", shape_dvec3_make(0, 1, 0));
    glUniform2f(glGetUniformLocation(program, "picture_size"), WIDTH, HEIGHT);
    glClearColor(0.36f, 0.52f, 0.72f, 1);

    const int side[3] = {SHAPE_NOISE_SIZE, SHAPE_NOISE_SIZE, SHAPE_NOISE_SIZE};
    GLuint noise =
        volume_texture(side, GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, GL_NEAREST, volume->noise->cells);
    gpu_cloud *clouds = calloc(volume->cloud_count + 1, sizeof *clouds);
    check(clouds ? SHAPE_OK : shape_error_memory(&error));
    for (size_t i = 0; i < volume->cloud_count; i++)
        upload(&clouds[i], volume, i, &light, noise);

    shape_view view = shape_view_defaults();
    view.width = WIDTH;
    view.height = HEIGHT;
    shape_dvec3 min, max;
    if (shape_set_bounds(set, &min, &max))
        shape_view_frame(&view, &light, min, max);
    const shape_dvec3 start = shape_dvec3_sub(view.eye, view.target);
    while (!glfwWindowShouldClose(window) && !glfwGetKey(window, GLFW_KEY_ESCAPE)) {
        double angle = argc == 3 ? 0 : glfwGetTime() / 4, c = cos(angle), s = sin(angle);
        view.eye = shape_dvec3_add(
            view.target, shape_dvec3_make(c * start.x + s * start.z, start.y, c * start.z - s * start.x));
        draw(program, clouds, volume->cloud_count, &view);
        if (argc == 3)
            return write_picture(argv[2]), 0;
        glfwSwapBuffers(window);
        glfwPollEvents();
    }
    glfwTerminate();
    return 0;
}
