"""moteus controllers behind an fdcanusb or on a UART."""
