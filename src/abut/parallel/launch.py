def require():
    pass
