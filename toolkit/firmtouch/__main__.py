"""`python -m firmtouch` is `firmtouch`."""

from firmtouch.cli import entry

if __name__ == "__main__":
    entry()
