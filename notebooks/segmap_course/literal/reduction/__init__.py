"""The reduction methods as A prints them: plain loops."""
