"""The pages of the documentation site that are made from sources and from runs."""
