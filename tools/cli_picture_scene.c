/* Camera and light between the picture options and a scene, and --save-scene of programs that make pictures. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli_picture.h"
#include "cli_scene.h"
#include "shape/air.h"

static void take(bool in_scene, const double *from, int count, double *to, bool *given)
{
    if (!in_scene || *given)
        return;
    memcpy(to, from, (size_t)count * sizeof *to);
    *given = true;
}

static void use_sky(const shape_scene *scene, cli_picture *v)
{
    static char rgb[128]; /* for the process's life, as a word of the command line */
    const double *c = scene->sky_radiance;
    if (!scene->sky_given || v->sky_given)
        return;
    snprintf(rgb, sizeof rgb, "%.17g,%.17g,%.17g", c[0], c[1], c[2]);
    v->sky = scene->sky == SHAPE_SKY_NONE ? "none" : scene->sky == SHAPE_SKY_CLEAR ? "clear" : rgb;
    v->sky_given = true;
}

void cli_picture_use_scene(const shape_scene *scene)
{
    static const double dark[3] = {0, 0, 0};
    cli_picture *v = &cli_picture_values;
    if (!v->sun_given) /* a sun that the command line names shines, whatever the scene says */
        take(scene->sun_none, dark, 3, v->sun_irradiance, &v->sun_irradiance_given);
    v->day_given = !v->sun_given && scene->day_given; /* a sun of the command line stands still */
    v->day = scene->day;
    take(scene->sun_given, scene->sun, 2, v->sun, &v->sun_given);
    take(scene->sun_irradiance_given, scene->sun_irradiance, 3, v->sun_irradiance, &v->sun_irradiance_given);
    take(scene->sun_angle_given, &scene->sun_angle, 1, &v->sun_angle, &v->sun_angle_given);
    take(scene->lamp_given, scene->lamp_intensity, 3, v->lamp_intensity, &v->lamp_intensity_given);
    take(scene->lamp_given, scene->lamp, 3, v->lamp, &v->lamp_given);
    use_sky(scene, v);
    if (!v->visibility_given || v->visibility > 0) /* the command line may take a scene's air away */
        take(scene->air_given && scene->air_height > 0, &scene->air_height, 1, &v->air_height,
             &v->air_height_given);
    take(scene->air_given, &scene->visibility, 1, &v->visibility, &v->visibility_given);
    take(scene->eye_given, scene->eye, 3, v->eye, &v->eye_given);
    take(scene->target_given, scene->target, 3, v->target, &v->target_given);
    take(scene->fov_given, &scene->fov, 1, &v->fov, &v->fov_given);
    take(scene->exposure_given, &scene->exposure, 1, &v->exposure, &v->exposure_given);
    for (int i = 0; i < 2 && scene->size_given && !v->size_given; i++)
        v->size[i] = scene->size[i];
    v->size_given = v->size_given || scene->size_given;
}

/* The sun as it was shown. It may have moved since the command line, by the time of day or in a window; where it has not,
 * the numbers are the command line's own. */
static void save_sun(const cli_picture *v, const shape_light *light, shape_scene *scene)
{
    const double degrees = 57.295779513082321;
    shape_dvec3 given = shape_sun_direction(v->sun[0], v->sun[1]), sun = light->sun;
    memcpy(scene->sun, v->sun, sizeof v->sun);
    if (given.x != sun.x || given.y != sun.y || given.z != sun.z) {
        scene->sun[0] = atan2(sun.x, sun.z) * degrees;
        scene->sun[1] = asin(fmax(-1, fmin(1, sun.y))) * degrees;
    }
    for (int i = 0; i < 3; i++) {
        float shown = light->sun_irradiance[i];
        scene->sun_irradiance[i] =
            (float)v->sun_irradiance[i] == shown ? v->sun_irradiance[i] : (double)shown;
    }
}

static void save_light(const cli_picture *v, const shape_light *light, shape_scene *scene)
{
    scene->sun_none = false;
    scene->sun_given = scene->sun_irradiance_given = scene->sky_given = true;
    save_sun(v, light, scene);
    scene->day_given = v->day_given;
    scene->day = v->day;
    for (int i = 0; i < 3 && v->day_given; i++)
        scene->sun_irradiance[i] = v->sun_irradiance[i]; /* the air takes its share again */
    scene->sun_angle_given = v->sun_angle_given;
    scene->sun_angle = v->sun_angle;
    scene->lamp_given = v->lamp_given;
    memcpy(scene->lamp, v->lamp, sizeof v->lamp);
    memcpy(scene->lamp_intensity, v->lamp_intensity, sizeof v->lamp_intensity);
    scene->air_given = shape_air_is(&light->air);
    scene->visibility = light->air.visibility;
    scene->air_height = light->air.height;
    scene->sky = light->sky;
    for (int i = 0; i < 3; i++)
        scene->sky_radiance[i] = (double)light->sky_radiance[i];
}

static void into_scene(const shape_view *view, const shape_light *light, shape_scene *scene)
{
    const double eye[3] = {view->eye.x, view->eye.y, view->eye.z},
                 target[3] = {view->target.x, view->target.y, view->target.z};
    save_light(&cli_picture_values, light, scene);
    scene->eye_given = scene->target_given = scene->fov_given = scene->size_given = true;
    memcpy(scene->eye, eye, sizeof eye);
    memcpy(scene->target, target, sizeof target);
    scene->fov = view->fov;
    scene->size[0] = view->width;
    scene->size[1] = view->height;
    scene->exposure_given = true;
    scene->exposure = (double)view->exposure;
}

/* The files of a scene as they are named from where it will be saved. */
static void rename_file(const cli_input *input, char **file)
{
    shape_error error;
    if (!*file)
        return;
    char *path = cli_scene_file(input->path, *file), *name = cli_save_name(path);
    cli_check(shape_scene_set_text(file, name, &error), &error);
    free(path);
    free(name);
}

static shape_scene *scene_of_file(const cli_input *input)
{
    shape_error error;
    shape_scene_cloud *cloud;
    shape_scene *scene = shape_scene_create(&error);
    if (!scene)
        cli_fail("%s", error.text);
    cli_check(shape_scene_add_cloud(scene, &cloud, &error), &error);
    cloud->file = cli_save_name(input->path);
    return scene;
}

void cli_picture_save_scene(const cli_input *input, const shape_view *view, const shape_light *light,
                            void (*more)(shape_scene *scene))
{
    if (!cli_save_wanted())
        return;
    shape_scene *scene = input->scene ? input->scene : scene_of_file(input);
    for (size_t i = 0; input->scene && i < scene->cloud_count; i++) {
        rename_file(input, &scene->clouds[i].file);
        rename_file(input, &scene->clouds[i].input);
    }
    for (size_t i = 0; input->scene && i < scene->mesh_count; i++)
        rename_file(input, &scene->meshes[i].file);
    if (more)
        more(scene);
    into_scene(view, light, scene);
    cli_save_scene(scene);
    if (!input->scene)
        shape_scene_destroy(scene);
}
