/* tests/bench/pitviper_bench.c: the program pitviper-bench, which `pitviper bench` runs in its place. */
#include "sensor/commands/program.h"
#include "sensor/node/run/stop.h"
#include "tests/bench/suites.h"

int main(int argc, char **argv)
{
    static char called[] = "pitviper bench"; /* in messages */
    program_fill_closed();
    thread_flush_denormals();
    if (!program_take_verbosity(&argc, argv)) return 2;
    if (program_asks_for("--version", "-V", argc, argv)) {
        puts("pitviper " PITVIPER_VERSION);
        return program_printed(0);
    }
    const bool help = program_asks_for("--help", "-h", argc, argv);
    if (!help && !program_tables_there(true, argc, argv)) return 1;
    stop_outlive_readers();
    if (argc > 0) argv[0] = called;
    const int code = bench_command(argc, argv, bench_next_suite);
    if (help && code == 0) printf("\n%s", program_common_help);
    return program_printed(code);
}
