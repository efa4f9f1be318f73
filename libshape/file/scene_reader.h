/* Private: between the files that read scenes from JSON. */
#ifndef SHAPE_FILE_SCENE_READER_H
#define SHAPE_FILE_SCENE_READER_H

#include <stddef.h>

#include <jansson.h>

#include "shape/scene.h"

/* Where the reader is, for errors. */
typedef struct scene_reader {
    const char *name;
    char path[192]; /* "clouds[2].copies[0].scale" */
    size_t places;
    shape_error *error;
} scene_reader;

/* What reads a value into *to. */
typedef shape_status (*scene_read)(scene_reader *r, const json_t *value, void *to);

/* A member of an object: its key, what reads its value, and where it goes within what the object is read into. */
typedef struct scene_member {
    const char *key;
    scene_read read;
    size_t offset;
} scene_member;

/* An error at the place where the reader is. */
shape_status scene_wrong(scene_reader *r, const char *format, ...) SHAPE_PRINTF(2, 3);

/* Adds ".key" or "[index]" to the path; the old length is what scene_leave() takes. */
size_t scene_enter(scene_reader *r, const char *key, size_t index);
void scene_leave(scene_reader *r, size_t used);

/* Reads each member by its row; "note" may stand in every object. */
shape_status scene_read_object(scene_reader *r, const json_t *object, const scene_member *members, void *to);

/* Reads each element of an array by `read`, to the same place. */
shape_status scene_read_each(scene_reader *r, const json_t *array, scene_read read, void *to);

shape_status scene_read_number(scene_reader *r, const json_t *value, double min, double max, double *number);
shape_status scene_read_three(scene_reader *r, const json_t *value, double min, double max,
                              double numbers[3]);
/* Three numbers, or one for all. */
shape_status scene_read_one_or_three(scene_reader *r, const json_t *value, double min, double max,
                                     double numbers[3]);

/* To a char *: a text that may stand in a line, and a note, which may be any text. */
shape_status scene_read_text(scene_reader *r, const json_t *value, void *to);
shape_status scene_read_note(scene_reader *r, const json_t *value, void *to);

/* To shape_scene_options. */
shape_status scene_read_options(scene_reader *r, const json_t *object, void *to);

/* Members of a place: to a shape_transform. */
shape_status scene_place_translate(scene_reader *r, const json_t *value, void *to);
shape_status scene_place_rotate(scene_reader *r, const json_t *value, void *to);
shape_status scene_place_scale(scene_reader *r, const json_t *value, void *to);
shape_status scene_place_mirror(scene_reader *r, const json_t *value, void *to);
shape_status scene_place_keep_depth(scene_reader *r, const json_t *value, void *to);

/* The members of a scene: to a shape_scene. */
shape_status scene_clouds(scene_reader *r, const json_t *value, void *to);
shape_status scene_edits(scene_reader *r, const json_t *value, void *to);
shape_status scene_ground(scene_reader *r, const json_t *value, void *to);
shape_status scene_meshes(scene_reader *r, const json_t *value, void *to);
shape_status scene_sun(scene_reader *r, const json_t *value, void *to);
shape_status scene_lamp(scene_reader *r, const json_t *value, void *to);
shape_status scene_sky(scene_reader *r, const json_t *value, void *to);
shape_status scene_air(scene_reader *r, const json_t *value, void *to);
shape_status scene_camera(scene_reader *r, const json_t *value, void *to);
shape_status scene_exposure(scene_reader *r, const json_t *value, void *to);

#endif
