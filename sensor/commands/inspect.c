/* sensor/commands/inspect.c: `pitviper inspect`: its options, the log, and which of the two formats is printed. */
#include "sensor/commands/inspect.h"
#include "sensor/commands/inspect_private.h"

#include <stdio.h>

static const char usage_text[] =
    "usage: pitviper inspect LOG [--pdus tsv [--full]] [--port N] [--exercise N]\n"
    "\n"
    "LOG is a pcap or pcapng capture, also compressed (gzip, zstd, bzip2, xz). Without --pdus: a summary of\n"
    "the exercise.\n"
    "\n"
    "  --pdus tsv    one line per Entity State PDU, with the columns and formats of\n"
    "                tshark -d udp.port==3000,dis -T fields\n"
    "  --full        with --pdus tsv: also entity type, dead reckoning, capabilities,\n"
    "                alternative type and articulation (change:attached:parameter:value; ...)\n"
    "  --port N      UDP destination port; 0: any that carries DIS (default: 3000, any when nothing went there)\n"
    "  --exercise N  only this exercise, 0 .. 255; default: all\n";

typedef struct Options {
    const char *path;
    bool        tsv, full;
    long long   port, exercise; /* exercise -1: all */
} Options;

static bool read_number(long long *out, const char *name, const char *text, long long low, long long high)
{
    long long value;
    if (!text || !text_to_long(&value, text) || value < low || value > high) {
        text_print(stderr, "pitviper inspect: %s wants a number %lld .. %lld, not `%s`\n", name, low, high,
                text ? text : "");
        return false;
    }
    *out = value;
    return true;
}

/* 0: go on; else the exit code + 1. */
static int read_options(Options *out, int argc, char **argv)
{
    Options o = {.port = dis_port_default, .exercise = -1};
    bool    only_paths = false;
    for (int i = 1; i < argc; i++) {
        const char *arg = argv[i], *value = i + 1 < argc ? argv[i + 1] : NULL;
        if (only_paths || arg[0] != '-' || !arg[1]) {
            if (o.path) {
                text_print(stderr, "pitviper inspect: one log at a time: `%s` and `%s`\n", o.path, arg);
                return 3;
            }
            o.path = arg;
        } else if (strcmp(arg, "--") == 0) {
            only_paths = true;
        } else if (strcmp(arg, "--help") == 0 || strcmp(arg, "-h") == 0) {
            fputs(usage_text, stdout);
            return 1;
        } else if (strcmp(arg, "--full") == 0) {
            o.full = true;
        } else if (strcmp(arg, "--pdus") == 0) {
            if (!value || strcmp(value, "tsv") != 0) {
                text_print(stderr, "pitviper inspect: --pdus knows `tsv`, not `%s`\n", value ? value : "");
                return 3;
            }
            o.tsv = true;
            i++;
        } else if (strcmp(arg, "--port") == 0) {
            if (!read_number(&o.port, arg, value, 0, 65535)) return 3;
            i++;
        } else if (strcmp(arg, "--exercise") == 0) {
            if (!read_number(&o.exercise, arg, value, 0, 255)) return 3;
            i++;
        } else {
            text_print(stderr, "pitviper inspect: unknown option `%s`; see pitviper inspect --help\n", arg);
            return 3;
        }
    }
    if (!o.path) {
        fputs(usage_text, stderr);
        return 3;
    }
    if (o.full && !o.tsv) {
        text_print(stderr, "pitviper inspect: --full goes with --pdus tsv\n");
        return 3;
    }
    *out = o;
    return 0;
}

int inspect_command(int argc, char **argv)
{
    Options   options;
    const int stop = read_options(&options, argc, argv);
    if (stop) return stop - 1;

    DisLog log;
    Status status = dis_log_open(&log, options.path, (int)options.port);
    if (status == STATUS_NO_MEMORY) log_error("inspect: %s: %s", options.path, status_name(status));
    if (status != STATUS_OK) return 1; /* all other errors have been logged */
    if (log.retimed)
        log_warn("inspect: packet times do not keep pace with the time stamps; the stamps are taken as the clock");
    if (log.any_port && options.port == dis_port_default)
        log_warn("inspect: nothing went to port %d: every port that carries DIS is taken; --port N chooses", dis_port);
    if (log.count == 0 && options.port > 0 && log.counters.other_port)
        log_warn("inspect: no UDP to port %lld in %s; try --port 0", options.port, options.path);

    if (options.tsv)
        inspect_tsv(&log, options.path, (int)options.exercise, options.full);
    else
        status = inspect_summary(&log, options.path, (int)options.exercise);
    if (status == STATUS_OK && dis_log_failed(&log)) status = STATUS_IO;
    dis_log_close(&log);
    if (status != STATUS_OK) {
        log_error("inspect: %s: %s", options.path, status_name(status));
        return 1;
    }
    if (fflush(stdout) != 0 || ferror(stdout)) {
        text_print(stderr, "pitviper inspect: cannot write the output; is the disk full or the pipe closed?\n");
        return 1;
    }
    return 0;
}
