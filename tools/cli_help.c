/* --help, from a program's table of options; what the manual page takes from that table as --help does. */
#include <stdio.h>
#include <string.h>

#include "cli.h"
#include "cli_private.h"

const char *cli_argument_name(const cli_option *option)
{
    static const char *const names[] = {NULL,     "X",   "N",  "N",    "X,Y,Z", "X,Y",
                                        "A|A..B", "WxH", NULL, "TEXT", "TEXT"};
    return option->choices ? option->choices : names[option->kind];
}

const char *cli_help_of(const cli_program *program, const cli_option *option)
{
    for (const cli_help *help = program->help; help && help->name; help++)
        if (!strcmp(help->name, option->name))
            return help->help;
    return option->help;
}

void cli_print_help(const cli_program *program)
{
    printf("Usage: %s [OPTION]... %s\n\n%s\n", program->name, program->arguments, program->about);
    for (const cli_group *group = program->groups; group->title; group++) {
        printf("\n%s:\n", group->title);
        for (const cli_option *option = group->options; option->name; option++) {
            char left[160], letter[6] = "";
            const char *argument = cli_argument_name(option);
            if (option->letter)
                snprintf(letter, sizeof letter, "-%c, ", option->letter);
            snprintf(left, sizeof left, "  %s--%s%s%s", letter, option->name, argument ? " " : "",
                     argument ? argument : "");
            if (strlen(left) > 30)
                printf("%s\n%32s%s\n", left, "", cli_help_of(program, option));
            else
                printf("%-32s%s\n", left, cli_help_of(program, option));
        }
    }
    if (program->examples)
        printf("\nExamples:\n%s", program->examples);
    printf("\nExit status: 0 done; 1 the work failed; 2 the command was wrong.\n");
}
