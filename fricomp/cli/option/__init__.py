"""Options that commands share: the part of a log, pages in the browser, logs for viewers."""
