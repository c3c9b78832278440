/* main.c: the commands, as one table. */
#include "sensor/node/inspect.h"
#include "sensor/node/replay.h"

#include <stdio.h>
#include <string.h>

static const struct Command {
    const char *name;
    int (*run)(int argc, char **argv);
    const char *help;
} commands[] = {
    {"replay", replay_command, "show what the missile's seeker in a recorded exercise saw"},
    {"inspect", inspect_command, "say who was in a recorded exercise, what they did, what was malformed"},
};
enum { command_count = sizeof commands / sizeof commands[0] };

static void usage(FILE *to)
{
    fputs("pitviper " PITVIPER_VERSION ": multispectral sensor simulation on DIS networks\n\n"
          "usage: pitviper COMMAND ...; `pitviper COMMAND --help` says more\n\n", to);
    for (int i = 0; i < command_count; i++) fprintf(to, "  %-10s %s\n", commands[i].name, commands[i].help);
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        usage(stderr);
        return 2;
    }
    if (strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0) {
        usage(stdout);
        return 0;
    }
    if (strcmp(argv[1], "--version") == 0) {
        puts("pitviper " PITVIPER_VERSION);
        return 0;
    }
    for (int i = 0; i < command_count; i++)
        if (strcmp(argv[1], commands[i].name) == 0) return commands[i].run(argc - 1, argv + 1);
    fprintf(stderr, "pitviper: no such command: %s\n\n", argv[1]);
    usage(stderr);
    return 2;
}
