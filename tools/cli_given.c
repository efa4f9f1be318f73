/* What the command line gave. */
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "cli.h"
#include "cli_private.h"

static const cli_option *given[CLI_MAX_OPTIONS];
static const char *texts[CLI_MAX_OPTIONS];
static int count;

void cli_given_start(void)
{
    count = 0;
}

void cli_note_given(const cli_option *option, const char *text)
{
    int i = 0;
    while (i < count && given[i] != option)
        i++;
    if (i == CLI_MAX_OPTIONS)
        return; /* no program has so many */
    given[i] = option;
    texts[i] = text;
    count += i == count;
}

static int place_of(const cli_option *option)
{
    for (int i = 0; i < count; i++)
        if (given[i] == option)
            return i;
    return -1;
}

bool cli_given(const char *name)
{
    for (int i = 0; i < count; i++)
        if (!strcmp(given[i]->name, name))
            return true;
    return false;
}

const char *cli_given_of(const cli_option *table)
{
    for (const cli_option *option = table; option->name; option++)
        if (place_of(option) >= 0)
            return option->name;
    return NULL;
}

static void append(char *text, size_t room, const char *more, size_t length)
{
    size_t used = strlen(text);
    if (used + length + 1 > room)
        length = room - used - 1;
    memcpy(text + used, more, length);
    text[used + length] = 0;
}

void cli_given_text(const cli_option *table, char *text, size_t room)
{
    for (const cli_option *option = table; option->name; option++) {
        int i = place_of(option);
        if (i < 0)
            continue;
        append(text, room, " --", 3);
        append(text, room, option->name, strlen(option->name));
        if (!texts[i])
            continue;
        append(text, room, " '", 2);
        for (const char *c = texts[i]; *c; c++)
            append(text, room, *c == '\'' ? "'\\''" : c, *c == '\'' ? 4 : 1);
        append(text, room, "'", 1);
    }
}

bool cli_has_suffix(const char *path, const char *suffix)
{
    size_t length = strlen(path), end = strlen(suffix);
    return length > end && !strcasecmp(path + length - end, suffix);
}
