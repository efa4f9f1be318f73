/* The shape generators as both the programs and scenes run them: option tables, and what makes a set of the options'
 * values. A generator's room is tools/cli_NAME.c; its program, tools/neph-NAME.c, adds help and main. */
#ifndef NEPHELE_CLI_GENERATOR_H
#define NEPHELE_CLI_GENERATOR_H

#include "cli.h"
#include "shape/scene.h"

typedef struct cli_generator {
    const char *name;        /* the program's */
    const char *input;       /* what its argument is, "GRAMMAR"; NULL: it takes none */
    const cli_group *groups; /* options that change the cloud; those that a scene may give, besides --seed */
    /* Makes the set from what the options' variables hold, and says what it made; mistakes end the program. input is a
     * path, or NULL. The caller destroys the set. NULL: only the generator's program can, and scenes run that. */
    shape_set *(*make)(const char *input, uint64_t seed);
} cli_generator;

extern const cli_generator cli_gauss, cli_meta, cli_layer, cli_lsys, cli_mesh;

/* All of them, ended by NULL. */
extern const cli_generator *const cli_generators[];

/* How many primitives a generator may make, where it allows `own` by itself: fewer within a scene. */
size_t cli_generator_limit(size_t own);
void cli_generator_set_limit(size_t limit);

/* The whole of a generator's program, which makes its set by `make`. program needs no groups. */
int cli_generator_main(const cli_program *program, const cli_generator *generator,
                       shape_set *(*make)(const char *input, uint64_t seed), int argc, char **argv);
/* Its parts: options, with more of the program's own where `more` is not NULL; and --save-scene. */
void cli_generator_parse(const cli_program *program, const cli_generator *generator, const cli_option *more,
                         int argc, char **argv, cli_common *common);
void cli_generator_save(const cli_generator *generator, const cli_common *common);

/* Runs a generator from within another program, by options as texts; the same bytes come out as from its own. place
 * stands before errors: "sky.json: clouds[2]". */
shape_set *cli_generator_run(const cli_generator *generator, const char *input,
                             const shape_scene_options *options, const char *place);
/* The same by running the generator's program, which stands beside this one or in PATH; the options were checked. */
shape_set *cli_generator_spawn(const cli_generator *generator, const char *input,
                               const shape_scene_options *options);
/* The path of the program that stands beside this one, in the caller's room, or its bare name, to be looked for in PATH. */
const char *cli_find_program(const char *name, char *path, size_t room);
/* Sets cli_medium_values to the defaults, and these options over them. place: "sky.json: clouds[2].medium". */
void cli_medium_set(const shape_scene_options *options, const char *place);

#endif
