"""What is believed of a log before it is read: its columns one by one, and the mapping to edit."""
