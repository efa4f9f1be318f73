/* What a command line said and read, kept for a cloud's provenance line and for scenes. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "cli.h"
#include "cli_private.h"

/* One process, one command line; while a scene's generator runs, its record stands here. */
static cli_record own, *current = &own;

cli_record *cli_record_use(cli_record *record)
{
    cli_record *before = current;
    current = record;
    return before;
}

void cli_record_start(const char *program)
{
    memset(current, 0, sizeof *current);
    current->program = program;
}

/* An option given twice counts once, with its last text. */
void cli_record_option(const cli_option *option, const char *text)
{
    int place = 0;
    while (place < current->count && current->options[place].option != option)
        place++;
    if (place == CLI_MAX_OPTIONS)
        return;
    current->count += place == current->count;
    current->options[place].option = option;
    current->options[place].text = text;
}

const cli_record *cli_record_now(void)
{
    return current;
}

/* Adds " text" to a line that is cut with " ..." rather than overrun. */
static void append(char *line, size_t room, const char *text)
{
    size_t used = strlen(line);
    if (used + strlen(text) + 2 <= room)
        snprintf(line + used, room - used, " %s", text);
}

void cli_append_input(const char *word)
{
    append(current->inputs, sizeof current->inputs, word);
}

static void append_option(char *line, size_t room, const cli_recorded *recorded)
{
    char word[512];
    if (recorded->option->unrecorded)
        return;
    snprintf(word, sizeof word, "--%s%s%s", recorded->option->name, recorded->text ? " " : "",
             recorded->text ? recorded->text : "");
    append(line, room, word);
}

void cli_made_by(char made_by[SHAPE_MADE_BY_MAX + 1])
{
    enum { OPTIONS_ROOM = 4096 };
    char whole[OPTIONS_ROOM + sizeof current->inputs];
    snprintf(whole, sizeof whole, "%s %s", current->program, shape_version());
    for (int i = 0; i < current->count; i++)
        append_option(whole, OPTIONS_ROOM, &current->options[i]);
    size_t length = strlen(whole);
    snprintf(whole + length, sizeof whole - length, "%s", current->inputs);
    length = strlen(whole);
    if (length > SHAPE_MADE_BY_MAX) {
        length = SHAPE_MADE_BY_MAX - 4;
        while (length && ((unsigned char)whole[length] & 0xc0) == 0x80)
            length--;
        snprintf(whole + length, sizeof whole - length, " ...");
    }
    cli_clean_text(whole);
    memcpy(made_by, whole, strlen(whole) + 1);
}
