"""A participant's process: how it joins the run, answers grants, and leaves."""
