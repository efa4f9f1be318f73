/* Between the cli_*.c files only. */
#ifndef NEPHELE_CLI_PRIVATE_H
#define NEPHELE_CLI_PRIVATE_H

#include "cli.h"

enum { CLI_MAX_OPTIONS = 160 };

/* An option that was given, and its text, NULL for a flag; both live as long as the record. */
typedef struct cli_recorded {
    const cli_option *option;
    const char *text;
} cli_recorded;

/* What a command line said and read. */
typedef struct cli_record {
    const char *program;
    cli_recorded options[CLI_MAX_OPTIONS];
    int count;
    char inputs[2048]; /* " name sha256:..." for each input */
} cli_record;

/* Empties the record and names its program. */
void cli_record_start(const char *program);
void cli_record_option(const cli_option *option, const char *text);
/* The record in use, and another to use instead; returns the former. */
const cli_record *cli_record_now(void);
cli_record *cli_record_use(cli_record *record);

/* Forgets what was given. */
void cli_given_start(void);
/* Keeps that an option was given; the text, NULL for a flag, lives as long as the program, or until it is given again. */
void cli_note_given(const cli_option *option, const char *text);

/* Puts an option's text into its variable, or ends the program: cli_wrong. text is "" for a flag, and must live as long
 * as the variable where that is a text. */
void cli_store(const cli_option *option, const char *text);

/* The name that every line on standard error begins with. */
void cli_set_program(const char *name);
/* Stands before every error from now on, "sky.json: clouds[2]: ", and makes what would be a wrong command a failure: the
 * mistake is in a file. "" ends it. */
void cli_set_place(const char *format, ...) SHAPE_PRINTF(1, 2);
/* Switches summaries and progress; returns what was before. */
bool cli_set_quiet(bool quiet);

/* Adds a word to the inputs named in the provenance line. */
void cli_append_input(const char *word);

/* What stands for an option's value in --help; NULL for a flag. */
const char *cli_argument_name(const cli_option *option);

/* An option's line of --help; a program may have its own for a common one. */
const char *cli_help_of(const cli_program *program, const cli_option *option);

/* --help on standard output; program->groups has all options, the common ones too. */
void cli_print_help(const cli_program *program);

typedef enum cli_generate_kind { CLI_GENERATE_MAN, CLI_GENERATE_BASH, CLI_GENERATE_ZSH } cli_generate_kind;
/* Writes a manual page or a shell's completion to common->output; program->groups has all options, the common ones
 * too. */
void cli_generate(const cli_common *common, const cli_program *program, cli_generate_kind kind);

/* Puts a question mark for each byte that may not stand in a .neph file's text: control characters, and what is no
 * UTF-8. File names may be anything; names and provenance lines go to terminals and JSON. */
void cli_clean_text(char *text);

#endif
