"""An identification for people: its page and its charts."""
