/* Between the cli_*.c files only. */
#ifndef NEPHELE_CLI_PRIVATE_H
#define NEPHELE_CLI_PRIVATE_H

/* Adds a word to the inputs named in the provenance line. */
void cli_append_input(const char *word);

/* Puts a question mark for each byte that may not stand in a .neph file's text: control characters, and what is no
 * UTF-8. File names may be anything; names and provenance lines go to terminals and JSON. */
void cli_clean_text(char *text);

#endif
