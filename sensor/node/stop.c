/* sensor/node/stop.c: records the signals that request a stop. */
#include "sensor/node/stop.h"

#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>

static atomic_int asked; /* the signal;  lock-free: a handler may set it, whichever thread it runs in */

static void ask(int number)
{
    int none = 0;
    atomic_compare_exchange_strong(&asked, &none, number);
}

void stop_by_signals(void)
{
    struct sigaction before, action = {.sa_handler = ask, .sa_flags = (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    if (sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, NULL);
}

bool stop_asked(void) { return atomic_load(&asked) != 0; }

int stop_exit_code(void)
{
    const int number = atomic_load(&asked);
    return number ? 128 + number : 0;
}
