"""python3 bench_page.py PAGE LEAST: the page of `pitviper bench --report` is HTML: every element that is opened is closed,
and more than LEAST are rows of tables."""
import html.parser
import sys


class Page(html.parser.HTMLParser):
    open, rows = [], 0

    def handle_starttag(self, tag, attributes):
        if tag not in ('meta', 'img', 'br'): self.open.append(tag)
        self.rows += tag == 'tr'

    def handle_startendtag(self, tag, attributes): pass

    def handle_endtag(self, tag):
        assert self.open.pop() == tag, (tag, self.getpos())


page = Page()
page.feed(open(sys.argv[1]).read())
assert not page.open and page.rows > int(sys.argv[2]), (page.open, page.rows)
