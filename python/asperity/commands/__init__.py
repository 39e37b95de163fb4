"""The command ``asperity``: one file for each verb, which reads options and prints."""
