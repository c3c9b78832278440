/* pitviper_log.c: status names, and one line a message. */
#include "pitviper.h"

#include <pthread.h>
#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

static pthread_mutex_t    log_lock = PTHREAD_MUTEX_INITIALIZER;
static LogSink           *log_sink;
static void              *log_user;
static LogLevel           log_lowest = LOG_INFO;
static _Thread_local bool suppressed_here;
static char               status_line[256]; /* the terminal's progress line, below the log */

const char *status_name(Status status)
{
    switch (status) {
    case STATUS_OK:
        return "ok";
    case STATUS_TRUNCATED:
        return "truncated";
    case STATUS_BAD_VALUE:
        return "bad value";
    case STATUS_UNSUPPORTED:
        return "unsupported";
    case STATUS_IO:
        return "input/output error";
    case STATUS_NO_MEMORY:
        return "out of memory";
    }
    return "unknown status";
}

void log_set_sink(LogSink *sink, void *user)
{
    pthread_mutex_lock(&log_lock);
    log_sink = sink;
    log_user = user;
    pthread_mutex_unlock(&log_lock);
}

void log_set_level(LogLevel lowest)
{
    pthread_mutex_lock(&log_lock);
    log_lowest = lowest;
    pthread_mutex_unlock(&log_lock);
}

static LogLevel lowest_shown(void)
{
    pthread_mutex_lock(&log_lock);
    const LogLevel lowest = log_lowest;
    pthread_mutex_unlock(&log_lock);
    return lowest;
}

bool log_is_quiet(void) { return lowest_shown() > LOG_INFO; }
bool log_is_verbose(void) { return lowest_shown() <= LOG_DETAIL; }

void log_suppress(bool hushed) { suppressed_here = hushed; }

const char *log_head(LogLevel level)
{
    return level == LOG_ERROR ? "pitviper: error: " : level == LOG_WARN ? "pitviper: warning: " : "";
}

static void log_line(LogLevel level, const char *format, va_list arguments)
{
    char raw[1024], line[4 * sizeof raw];
    if (suppressed_here) return;
    vsnprintf(raw, sizeof raw, format, arguments);
    text_show(line, sizeof line, raw, false); /* names in files and messages of libraries may contain any octets */
    pthread_mutex_lock(&log_lock);
    if (level >= log_lowest) {
        if (log_sink) log_sink(log_user, level, line);
        else fprintf(stderr, "%s%s%s\n%s", *status_line ? "\r\x1b[K" : "", log_head(level), line, status_line);
    }
    pthread_mutex_unlock(&log_lock);
}

void log_status(const char *text)
{
    pthread_mutex_lock(&log_lock);
    const bool shown = *status_line != 0, may = !log_sink && log_lowest <= LOG_INFO && isatty(STDERR_FILENO);
    if (may && text) {
        snprintf(status_line, sizeof status_line, "  %s", text);
        fprintf(stderr, "\r\x1b[K%s", status_line);
    } else if (shown) {
        *status_line = 0;
        fputs("\r\x1b[K", stderr);
    }
    fflush(stderr);
    pthread_mutex_unlock(&log_lock);
}

void log_print(const char *format, ...)
{
    va_list arguments;
    if (log_is_quiet()) return;
    va_start(arguments, format);
    text_vprint(stdout, format, arguments);
    va_end(arguments);
}

void log_detail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    log_line(LOG_DETAIL, format, arguments);
    va_end(arguments);
}

void log_info(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    log_line(LOG_INFO, format, arguments);
    va_end(arguments);
}

void log_warn(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    log_line(LOG_WARN, format, arguments);
    va_end(arguments);
}

void log_error(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    log_line(LOG_ERROR, format, arguments);
    va_end(arguments);
}
