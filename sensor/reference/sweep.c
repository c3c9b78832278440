/* sensor/reference/sweep.c: manifest.jsonl and the page of a sweep. */
#include "sensor/reference/reference.h"

static const ReferenceField fields[] = {
    {"variant", "string", "", "", "", "its name, a hash of its settings"},
    {"folder", "string", "", "from the folder of manifest.jsonl", "", "where its products are"},
    {"number", "integer", "", "from 1", "", "its position in the sweep"},
    {"status", "string", "", "", "", "`made`; `kept`: complete from an earlier run; `failed`"},
    {"settings", "object", "", "", "", "settings of the axes"},
    {"settings.KEY", "string", "as in `pitviper check --default`", "", "", "its value as text"},
    {"config_sha256", "string", "", "", "", "as in its run.json"},
    {"settings_sha256", "string", "", "", "", "SHA-256 of its settings.yaml"},
    {"log_sha256", "string", "", "", "", "SHA-256 of the log's octets"},
    {"pitviper", "string", "", "", "", "version of the program"},
    {"error", "string", "", "", "when it has not failed", "reason; details in log.txt of its folder"},
    {"seconds", "number", "s", "", "when it was kept", "run time"},
    {"frames", "integer", "", "", "when it failed", "number of frames rendered"},
    {"frame_sha256", "list of strings", "", "", "when it failed", "as in its run.json"},
};
static const ReferenceWord words[] = {
    {"KEY", "a setting's section and key with a dot between, such as weather.visibility_m", NULL, NULL},
};

const Reference reference_manifest = {
    .topic = "manifest",
    .file  = "manifest.jsonl",
    .title = "the variants of a sweep: a line of JSON each",
    .about = "Of --sweep FILE. Each variant's line, with status `made`, is also its FOLDER/variant.json: it marks\n"
             "the variant as complete, to be kept by the next run.",
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
     "its bands side by side, middle frame of the run; alt: its folder"},
    {"figure/figcaption", "element", "", "", "", "its folder in <b>, then a line per setting"},
};

const Reference reference_sheet = {
    .topic = "sheet",
    .file  = "manifest.html",
    .title = "thumbnails of the variants of a sweep",
    .about = "Of --sweep FILE, beside manifest.jsonl, which is machine-readable. FOLDER/thumbnail.png is the image of "
             "a variant.",
    .notation = "Field: element of HTML.",
    .field = REFERENCE_FIELDS(sheet_fields),
    .python =
        "import html.parser\n"
        "class Sheet(html.parser.HTMLParser):\n"
        "    def handle_starttag(self, tag, attributes):\n"
        "        if tag == 'img':\n"
        "            image = dict(attributes)\n"
        "            print(image['alt'], image['src'][:22], len(image['src']))\n"
        "Sheet().feed(open('manifest.html').read())\n",
};
