/* source.c: what the viewer shows: a .neph, a grammar that is derived here, or what a generator's program makes. */
#ifndef NEPHELE_VIEW_SOURCE_H
#define NEPHELE_VIEW_SOURCE_H

#include <stdint.h>

#include "shape/set.h"
#include "things.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VIEW_PATH_MAX = 4096 }; /* bytes of a file's path */

enum { VIEW_SETTINGS_MAX = 32 };

/* One option of a generator. Flags and choices are whole numbers, ranges low and high; where it is not given, what the
 * generator takes by itself, as far as that is known. */
typedef struct view_setting {
    bool given;
    double number[3];
} view_setting;

/* How a cloud is made: the options of neph-lsys, neph-gauss, neph-meta or neph-mesh, see setting.h. */
typedef struct view_generator {
    int which; /* of cli_generators; -1: nothing makes it, it is read */
    int entry; /* of the opened scene, from 1 on, whose cloud it makes; 0: the file is no scene */
    uint64_t seed;
    uint64_t digest; /* of what that entry says in the file */
    view_setting settings[VIEW_SETTINGS_MAX];
} view_generator;

/* run.c: a program that is running, so that another thread can end it. */
typedef struct view_run view_run;

/* What a file held. */
typedef struct view_contents {
    shape_set *set;      /* the caller destroys it */
    view_generator used; /* what made it, settings of a grammar's file included */
    shape_scene *scene;  /* where it is one, for its light and camera; the caller destroys it. NULL else */
    bool things_read;
    shape_opaque *opaque; /* where things were read: what is opaque, or NULL; the caller destroys it */
} view_contents;

/* Reads a .neph, or a grammar and derives it as neph-lsys does; or runs the generator's program, on a mesh or on nothing
 * (path ""). path "-": standard input. What it is shows in the name, else in the bytes. run may be NULL. A scene's clouds
 * are made by the program neph-edit. more: what else is opaque, or NULL; things: whether what is opaque is to be read,
 * as it always is with a scene. Mistakes of a grammar: "path:line:column: text", all of them (as far as there is room), one a line. */
shape_status view_source_read(const char *path, const view_generator *generator, view_run *run,
                              const view_more_things *more, bool things, view_contents *contents,
                              char *mistakes, size_t room, shape_error *error);
void view_contents_free(view_contents *contents);
/* The same of a file's bytes that have been read already, a .neph's or a grammar's. */
shape_status view_source_decode(const char *path, const unsigned char *bytes, size_t size,
                                const view_generator *generator, view_run *run, view_contents *contents,
                                char *mistakes, size_t room, shape_error *error);

#ifdef __cplusplus
}
#endif
#endif
