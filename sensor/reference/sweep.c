/* sensor/reference/sweep.c: manifest.jsonl and the page of a sweep. */
#include "sensor/reference/reference.h"

static const ReferenceField fields[] = {
    {"variant", "string", "", "", "", "its name, by what it sets"},
    {"folder", "string", "", "from the folder of manifest.jsonl", "", "where its products are"},
    {"number", "integer", "", "from 1", "", "its place in the sweep"},
    {"status", "string", "", "", "", "`made`; `kept`: it was there; `failed`"},
    {"settings", "object", "", "", "", "what the sweep's axes set"},
    {"settings.KEY", "string", "as in `pitviper check --default`", "", "", "its value as text"},
    {"config_sha256", "string", "", "", "", "as in its run.json"},
    {"settings_sha256", "string", "", "", "", "SHA-256 of its settings.yaml"},
    {"log_sha256", "string", "", "", "", "SHA-256 of the log's octets"},
    {"pitviper", "string", "", "", "", "version of the program"},
    {"error", "string", "", "", "when it has not failed", "why it failed; log.txt of its folder says more"},
    {"seconds", "number", "s", "", "when it was kept", "how long it took"},
    {"frames", "integer", "", "", "when it failed", "how many were made"},
    {"frame_sha256", "list of strings", "", "", "when it failed", "as in its run.json"},
};
static const ReferenceWord words[] = {
    {"KEY", "a setting's section and key with a dot between, such as weather.visibility_m", NULL, NULL},
};

const Reference reference_manifest = {
    .topic = "manifest",
    .file  = "manifest.jsonl",
    .title = "the variants of a sweep: a line of JSON each",
    .about = "Of --sweep FILE. Each variant's line, with status `made`, is also its FOLDER/variant.json: by it the next run\n"
             "knows that the variant can be kept.",
    .field = REFERENCE_FIELDS(fields),
    .word  = REFERENCE_FIELDS(words),
    .python =
        "import json, os\n"
        "for line in open('manifest.jsonl'):\n"
        "    variant = json.loads(line)\n"
        "    if variant['status'] == 'failed':\n"
        "        print(variant['number'], variant['error'])\n"
        "        continue\n"
        "    truth = [json.loads(l) for l in open(os.path.join(variant['folder'], 'truth.jsonl'))]\n"
        "    print(variant['settings'], variant['frames'], 'frames', len(truth[0]['targets']), 'targets in "
        "the first')\n",
};

static const ReferenceField sheet_fields[] = {
    {"figure", "element", "", "", "", "a variant"},
    {"figure/img", "element", "", "src: PNG as data:, of variants beyond 400 FOLDER/thumbnail.png", "without PNGs",
     "its bands side by side at the middle frame of its run; alt: its folder"},
    {"figure/figcaption", "element", "", "", "", "its folder in <b>, then a line a setting"},
};

const Reference reference_sheet = {
    .topic = "sheet",
    .file  = "manifest.html",
    .title = "the variants of a sweep as pictures, for people",
    .about = "Of --sweep FILE, beside manifest.jsonl, which is for programs. FOLDER/thumbnail.png is each variant's picture.",
    .notation = "Field: element of HTML.",
    .field = REFERENCE_FIELDS(sheet_fields),
    .python =
        "import html.parser\n"
        "class Sheet(html.parser.HTMLParser):\n"
        "    def handle_starttag(self, tag, attributes):\n"
        "        if tag == 'img':\n"
        "            picture = dict(attributes)\n"
        "            print(picture['alt'], picture['src'][:22], len(picture['src']))\n"
        "Sheet().feed(open('manifest.html').read())\n",
};
