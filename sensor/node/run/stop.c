/* sensor/node/run/stop.c: records the signals that request a stop. */
#include "sensor/node/run/stop.h"

#include "pitviper_file.h"

#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>

static atomic_int asked; /* the signal;  lock-free: a handler may set it, whichever thread it runs in */

static void ask(int number)
{
    int none = 0;
    atomic_compare_exchange_strong(&asked, &none, number);
}

/* Handles a signal, unless it is handled or ignored already. */
static void handle(int number, void (*handler)(int), bool always)
{
    struct sigaction before, action = {.sa_handler = handler, .sa_flags = handler == SIG_IGN ? 0 : (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    if (always || (sigaction(number, NULL, &before) == 0 && before.sa_handler == SIG_DFL))
        sigaction(number, &action, NULL);
}

void stop_by_signals(void)
{
    static const int others[] = {SIGHUP, SIGUSR1, SIGUSR2, SIGXCPU, SIGALRM, SIGVTALRM, SIGPROF, SIGPOLL, SIGPWR};
    handle(SIGINT, ask, true);
    handle(SIGTERM, ask, true);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) handle(others[i], ask, false);
    for (int number = SIGRTMIN; number <= SIGRTMAX; number++) handle(number, ask, false);
    stop_outlive_readers();
    file_stop_when(stop_asked);
}

void stop_outlive_readers(void)
{
    handle(SIGPIPE, SIG_IGN, false);
    handle(SIGXFSZ, SIG_IGN, false);
}

bool stop_asked(void) { return atomic_load(&asked) != 0; }

int stop_exit_code(void)
{
    const int number = atomic_load(&asked);
    return number ? 128 + number : 0;
}
