/* sensor/commands/regress_command.c: the command `pitviper regress`, and its action `bisect`. */
#include "sensor/commands/commands.h"

#include "sensor/verify/bisect/bisect.h"
#include "sensor/verify/regress/regress.h"

#include <string.h>

int regress_command(int argc, char **argv)
{
    static char called[] = "pitviper regress bisect";
    if (argc < 2 || strcmp(argv[1], "bisect") != 0) return regress_cases_command(argc, argv);
    argv[1] = called; /* program name in getopt's messages */
    return bisect_command(argc - 1, argv + 1);
}
