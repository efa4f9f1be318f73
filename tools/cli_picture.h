/* The picture options of every program that makes one: size, view, sun, sky, exposure. */
#ifndef NEPHELE_CLI_PICTURE_H
#define NEPHELE_CLI_PICTURE_H

#include "cli_scene.h"
#include "shape/view.h"

typedef struct cli_picture {
    int64_t size[2];
    double eye[3], target[3], fov, sun[2], sun_irradiance[3], exposure;
    double visibility, air_height;
    const char *sky;
    double sun_angle, lamp[3], lamp_intensity[3]; /* options of neph-render alone, and of scenes */
    shape_day day; /* of scenes: where the sun stands, and what the air leaves of it */
    bool day_given;
    bool sun_angle_given, lamp_given, lamp_intensity_given;
    bool size_given, eye_given, target_given, fov_given, sun_given, sun_irradiance_given, sky_given,
        exposure_given, visibility_given, air_height_given;
} cli_picture;

extern cli_picture cli_picture_values;
/* The rows that fill cli_picture_values; put them into a group titled "Picture". */
extern const cli_option cli_picture_options[];

/* Fills view and light from the defaults and the command line. Without --eye the view frames the set (a --target then
 * turns the framed view there); with --eye and without --target it looks at the set's middle. A sky
 * that is no sky, or an eye on its target, ends the program with exit 2. */
void cli_picture_apply(const shape_set *set, shape_view *view, shape_light *light);

/* Takes from a scene what the command line has not given; before cli_picture_apply. */
void cli_picture_use_scene(const shape_scene *scene);
/* Does --save-scene: the clouds and meshes as they came in, seen and lit as they were shown. more adds what the command
 * line brought beside them; NULL: nothing. */
void cli_picture_save_scene(const cli_input *input, const shape_view *view, const shape_light *light,
                            void (*more)(shape_scene *scene));

#endif
