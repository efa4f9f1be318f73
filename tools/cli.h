/* What every program does alike: options from one table (parsing, ranges, --help), streams, errors, exit codes,
 * provenance. A program declares its options as rows, calls cli_parse, works, and ends by cli_finish. */
#ifndef NEPHELE_CLI_H
#define NEPHELE_CLI_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "shape/set.h"
#include "shape/status.h"

/* Exit codes. */
enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_WRONG = 2 };

typedef enum cli_kind {
    CLI_FLAG,    /* bool: true where given */
    CLI_NUMBER,  /* double in [min, max] */
    CLI_INTEGER, /* int64_t in [min, max] */
    CLI_SEED,    /* uint64_t, any */
    CLI_VECTOR,  /* double[3], X,Y,Z, each in [min, max] */
    CLI_PAIR,    /* double[2], X,Y, each in [min, max] */
    CLI_RANGE,   /* double[2]: A or A..B, in [min, max], A <= B */
    CLI_SIZE,    /* int64_t[2]: WxH, each in [min, max] */
    CLI_CHOICE,  /* int: the place of the word in `choices`, "a|b|c" */
    CLI_TEXT,    /* const char *, as given */
    CLI_TEXTS    /* cli_texts: an option that may be given several times, in this order */
} cli_kind;

enum { CLI_SCENE_ONLY = 2 };
enum { CLI_TEXTS_MAX = 64 };
typedef struct cli_texts {
    const char *text[CLI_TEXTS_MAX]; /* for the program's life */
    int count;
} cli_texts;

typedef struct cli_option {
    const char *name; /* long name, without the dashes; NULL ends a table */
    char letter;      /* short name, or 0 */
    cli_kind kind;
    void *value;     /* where it goes; holds the default before */
    double min, max; /* inclusive; both 0: any finite number */
    const char
        *choices;     /* CLI_CHOICE: the words; else the argument's name in --help (N, L, X,Y,Z), or NULL */
    const char *help; /* one line, with the unit; the default is shown in square brackets at its end */
    bool *given;      /* set where the option is given; may be NULL */
    int unrecorded; /* true: it is left out of `made_by`, since it changes nothing in the file (-o, -q, --print);
                         CLI_SCENE_ONLY: likewise, but a scene keeps it (a limit) */
} cli_option;

/* A named group of options, shown together in --help. */
typedef struct cli_group {
    const char *title;
    const cli_option *options;
} cli_group;

/* Another help text for an option of a shared table, whose default is another one here. */
typedef struct cli_help {
    const char *name, *help; /* NULL ends the list */
} cli_help;

typedef struct cli_program {
    const char *name;      /* "neph-lsys" */
    const char *arguments; /* "GRAMMAR" or "" */
    const char *about;     /* a sentence or two for --help */
    const char *examples;  /* lines for --help and the manual, each ending in \n; may be NULL */
    int min_arguments, max_arguments;
    const cli_group *groups; /* ended by a group with title NULL */
    const cli_help *help;    /* may be NULL */
} cli_program;

/* What every program has. */
typedef struct cli_common {
    const char *output; /* "-" where not given */
    bool quiet;
    uint64_t seed;
    int argument_count;
    const char **arguments; /* the positional ones; owned by cli, freed by cli_finish */
    bool seed_given, output_given;
} cli_common;

/* Parses argv. --help and --version print on standard output and exit 0; a wrong command prints one line on standard
 * error and exits 2. */
void cli_parse(const cli_program *program, int argc, char **argv, cli_common *common);

/* `program: text (...)` on standard error. */
void cli_error(const char *format, ...) SHAPE_PRINTF(1, 2);
/* The same, then exit 1. */
__attribute__((noreturn)) void cli_fail(const char *format, ...) SHAPE_PRINTF(1, 2);
/* The same, then exit 2: for combinations of options that make no sense. */
__attribute__((noreturn)) void cli_wrong(const char *format, ...) SHAPE_PRINTF(1, 2);
/* Ends the program by exit(). Where work that may end so is done on a thread, call() is called from it first, and may keep
 * it there while another thread ends the program; NULL: no more. */
__attribute__((noreturn)) void cli_end(int code);
void cli_before_end(void (*call)(int code));
/* Whether the command line gave an option by this name, and the first of a table that it gave, or NULL. */
bool cli_given(const char *name);
const char *cli_given_of(const cli_option *table);
/* Appends the options of a table that were given, " --name text", as a shell reads them back; cut at room bytes. */
void cli_given_text(const cli_option *table, char *text, size_t room);

/* Whether a path ends in ".vdb" or the like, in capitals or not. */
bool cli_has_suffix(const char *path, const char *suffix);

/* Nothing where status is SHAPE_OK, else the error's text and exit 1. */
void cli_check(shape_status status, const shape_error *error);
/* A summary line on standard error, unless -q. */
void cli_say(const char *format, ...) SHAPE_PRINTF(1, 2);

/* Progress on standard error, where that is a terminal, the work has lasted a second and -q is not given:
 * `what 42 % (3 s left)`. done in [0, 1]; 1 wipes the line. Cheap enough to call often. */
void cli_progress(const char *what, double done);

/* Strict numbers, for programs with texts of their own: the whole of text, finite, no blanks. */
bool cli_number(const char *text, double *value);
bool cli_numbers(const char *text, int count, double *values); /* separated by commas */

/* Writes the bytes to common->output: a file that appears whole or not at all, or standard output. Binary to a
 * terminal is refused. Exits 1 on failure. */
void cli_write(const cli_common *common, const void *bytes, size_t size, bool binary);
/* Encodes a set and writes it. */
void cli_write_set(const cli_common *common, const shape_set *set);
/* Reads a .neph from a path or "-"; exits 1 with `path: what is wrong`. The caller destroys the set. */
shape_set *cli_read_set(const char *path);

/* The provenance line of a cloud: program, version, the options given (but for the unrecorded ones), the seed, and
 * each input's bare name and SHA-256. cli_note_input is called for each input with its bytes, before. Cut at
 * SHAPE_MADE_BY_MAX with " ...". */
void cli_note_input(const char *path, const void *bytes, size_t size);
void cli_made_by(char made_by[SHAPE_MADE_BY_MAX + 1]);
/* The path's last part without its suffix: a cloud's name from an input's or output's. "-" gives `otherwise`. */
void cli_bare_name(const char *path, const char *otherwise, char name[SHAPE_NAME_MAX + 1]);

/* Flushes standard output and returns the exit code; a closed or full output is an error. */
int cli_finish(cli_common *common);

/* --- the medium options of CONTRACT.md (cli_medium.c) --- */

typedef struct cli_medium {
    int model;
    double extinction, albedo, g, kappa, noise_scale, edge, g2, lobe_mix, droplet, at[3];
    double smoothness, displace, displace_scale, billow, wisp, detail_depth, detail_scale;
    int64_t octaves;
    int phase;
    bool model_given, extinction_given, albedo_given, phase_given, g_given, kappa_given, octaves_given,
        noise_scale_given, edge_given, g2_given, lobe_mix_given, droplet_given, at_given, smoothness_given,
        displace_given, displace_scale_given, billow_given, wisp_given, detail_depth_given,
        detail_scale_given;
} cli_medium;

extern cli_medium cli_medium_values;
extern const cli_medium cli_medium_defaults;
/* The rows that fill cli_medium_values; put them into a group titled "Medium and frame". */
extern const cli_option cli_medium_options[];
/* Those of them that do not ask for primitives: extinction to droplet, and --at. */
extern const cli_option cli_optics_options[];
/* Overrides in *cloud what was given on the command line, and places it by --at (added to the frame's translation). */
void cli_medium_apply(shape_cloud *cloud);

#endif
