/* Between the cli_*.c files only. */
#ifndef NEPHELE_CLI_PRIVATE_H
#define NEPHELE_CLI_PRIVATE_H

#include "cli.h"

/* Adds a word to the inputs named in the provenance line. */
void cli_append_input(const char *word);

/* What stands for an option's value in --help; NULL for a flag. */
const char *cli_argument_name(const cli_option *option);

typedef enum cli_generate_kind { CLI_GENERATE_MAN, CLI_GENERATE_BASH, CLI_GENERATE_ZSH } cli_generate_kind;
/* Writes a manual page or a shell's completion to common->output; program->groups has all options, the common ones
 * too. */
void cli_generate(const cli_common *common, const cli_program *program, cli_generate_kind kind);

/* Puts a question mark for each byte that may not stand in a .neph file's text: control characters, and what is no
 * UTF-8. File names may be anything; names and provenance lines go to terminals and JSON. */
void cli_clean_text(char *text);

#endif
