"""A page on 127.0.0.1 on which a joint that moves can be watched, and stopped; nothing else can be reached from it.

The control thread writes each cycle into shared memory (`ring`) and waits for nobody. A process of its own (`server`)
reads there, fits the curve that fills, and serves the page; it shares no interpreter with the loop, so that a browser
cannot delay a cycle. Back comes one word, `stop`, on which a thread that sleeps until then calls the adapter's own
`safe_stop` (`feed`). Nothing is imported here: the process of the page comes up without the packages of the loop.
"""
