/* sensor/verify/regress/regress_junit.c: the XML that test servers read (testsuite, testcase, failure, error,
 * skipped). */
#include "sensor/verify/regress/run_case.h"
#include "pitviper_output.h"

#include <errno.h>
#include <unistd.h>

/* Text and attributes of XML 1.0: no control characters at all, and nothing that is not ASCII. */
static void put(FILE *to, const char *text)
{
    for (; *text; text++) {
        const unsigned char c = (unsigned char)*text;
        if (c == '&') fputs("&amp;", to);
        else if (c == '<') fputs("&lt;", to);
        else if (c == '>') fputs("&gt;", to);
        else if (c == '"') fputs("&quot;", to);
        else if (c == '\n') fputs("&#10;", to);
        else fputc(c < ' ' || c >= 0x7f ? '?' : c, to);
    }
}

static void put_case(FILE *to, const CaseResult *r)
{
    static const char *const kind[CASE_STATES] = {NULL, "failure", "error", "failure", "skipped"};
    fputs("  <testcase classname=\"pitviper.regress\" name=\"", to);
    put(to, r->c.name);
    fprintf(to, "\" time=\"%.3f\">\n", r->seconds);
    if (kind[r->state]) {
        fprintf(to, "    <%s message=\"", kind[r->state]);
        put(to, r->line);
        if (r->state == CASE_SKIPPED) {
            fputs("\"/>\n", to);
        } else {
            fputs("\">", to);
            put(to, r->c.purpose);
            if (r->compared && *r->verdict.remarks) {
                fputs("\ninputs that differ from those of the baseline:\n", to);
                put(to, r->verdict.remarks);
            }
            for (int k = 0; k < CHANNEL_COUNT && r->compared; k++)
                if (r->verdict.channel[k].failed) {
                    fprintf(to, "\n%s: ", verdict_channel_name((Channel)k));
                    put(to, r->verdict.channel[k].line);
                }
            if (*r->command) fputs("\n\nto reproduce:\n", to);
            put(to, r->command);
            fprintf(to, "</%s>\n", kind[r->state]);
        }
    }
    if (r->compared && *r->verdict.remarks && !kind[r->state]) {
        fputs("    <system-out>", to);
        put(to, r->verdict.remarks);
        fputs("</system-out>\n", to);
    }
    if (*r->said) {
        fputs("    <system-err>", to);
        put(to, r->said);
        fputs("</system-err>\n", to);
    }
    fputs("  </testcase>\n", to);
}

Status regress_junit_write(const char *path, const CaseResult *const *result, int count)
{
    int    of[CASE_STATES] = {0};
    double seconds = 0;
    for (int i = 0; i < count; i++) {
        of[result[i]->state]++;
        seconds += result[i]->seconds;
    }
    FILE *file = output_begin(path, OUTPUT_STREAM);
    if (!file) {
        log_error("regress: --junit: cannot write %s: %s; choose another path", path, output_reason(errno));
        return STATUS_IO;
    }
    fprintf(
        file,
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"pitviper regress\" tests=\"%d\" failures=\"%d\" "
        "errors=\"%d\" skipped=\"%d\" time=\"%.3f\">\n",
        count, of[CASE_FAILED] + of[CASE_NO_RECORD], of[CASE_BROKEN], of[CASE_SKIPPED], seconds);
    for (int i = 0; i < count; i++) put_case(file, result[i]);
    fputs("</testsuite>\n", file);
    if (output_end(file, path)) return STATUS_OK;
    log_error("regress: --junit: cannot write %s: %s", path, output_reason(errno));
    return STATUS_IO;
}
