/* setting.c: the generators' options as numbers that a panel can change, from the same tables that the programs read their
 * command lines by (tools/cli_generator.h). */
#ifndef NEPHELE_VIEW_SETTING_H
#define NEPHELE_VIEW_SETTING_H

#include "shape/scene.h"
#include "source.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum view_setting_kind {
    VIEW_SETTING_NUMBER,
    VIEW_SETTING_INTEGER,
    VIEW_SETTING_FLAG,
    VIEW_SETTING_CHOICE
} view_setting_kind;

typedef struct view_setting_row {
    const char *name, *help; /* of the option; its default stands in brackets at the end of help */
    const char *choices;     /* "a|b|c" */
    view_setting_kind kind;
    int count;       /* numbers: 1 to 3 */
    bool range;      /* they are a lowest and a highest one */
    double min, max; /* of each; both 0: any */
} view_setting_row;

/* Nothing but this seed: what is read, or a grammar by its own file. */
view_generator view_generator_none(uint64_t seed);
/* The generator of a program's name, with its own defaults; which is -1 where there is none that can be changed. */
view_generator view_generator_named(const char *program, uint64_t seed);
/* What makes a cloud of a file with that name: neph-mesh of a mesh, neph-lsys of a .lsys; else which is -1. */
view_generator view_generator_of_path(const char *path, uint64_t seed);
/* "neph-gauss"; "" for none. */
const char *view_generator_program(const view_generator *generator);

/* Row i of a generator's options, those of the medium left out; false behind the last. */
bool view_setting_get_row(const view_generator *generator, int i, view_setting_row *row);
/* The place of an option, or -1. */
int view_setting_find(const view_generator *generator, const char *name);
/* The value as a command line has it; "" for a flag. */
void view_setting_text(const view_setting_row *row, const view_setting *setting, char *text, size_t room);
/* The reverse; text NULL: a flag. False where it is no value of that row. */
bool view_setting_read(const view_setting_row *row, const char *text, view_setting *setting);
/* Adds what is given, as a scene has it, and the seed where it is wanted. */
shape_status view_setting_options(const view_generator *generator, bool seed, shape_scene_options *options,
                                  shape_error *error);
/* Whether two generators make the same. */
bool view_generator_same(const view_generator *a, const view_generator *b);

#ifdef __cplusplus
}
#endif
#endif
