"""One module per executable, each with a main()."""
